"""Records on the mesh of what was written to it; the form's key, found by its record."""
