"""Other methods for canonical forms, to compare with: one file each, all on the same geodesics."""
