"""The mesh as an elastic body: rotations, stretches, struts through the interior, pressure."""
