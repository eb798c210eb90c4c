"""Jobs: from the objects that are meant, by a computation apart from Blender, to results written at the end."""
