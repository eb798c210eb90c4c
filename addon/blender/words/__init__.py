"""What is said to the user: in the language of Blender, with advice where a menu has the remedy."""
