"""Reads and writes every kind of file; checks what may be read and written; leaves no partial files."""
