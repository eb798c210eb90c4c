"""The command compute: many files, several at once, with or without Blender."""
