"""Errors, messages (kinds with numbers), progress and cancellation, the memory limit."""
