"""The border to Blender's data: meshes in, results out, files in and out."""
