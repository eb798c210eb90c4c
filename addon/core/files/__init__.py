"""Results as files: saved, and loaded again."""
