"""Accuracy of rigs: characters in poses of their own bones, rigged from references, beside Blender's weights."""
