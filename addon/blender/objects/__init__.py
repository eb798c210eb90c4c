"""Objects read as arrays: their meshes, seams, mirrors and modifiers, alone or several as one mesh."""
