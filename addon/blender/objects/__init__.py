"""Objects as arrays, as they are or as shown, with seams closed and mirrors undone; several as one mesh."""
