"""Records on the mesh of what was written to it, also of earlier versions; the form's key, found by its record."""
