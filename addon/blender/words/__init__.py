"""Messages in Blender's language, advice that names the menu that solves a problem, sentences for file errors."""
