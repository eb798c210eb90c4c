"""Where a form lies, and how a reference numbers its feature points."""
