"""The methods: one file each, found by themselves. A file defines `METHODS`, a tuple of `Method`."""
