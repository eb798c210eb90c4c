"""The mesh as an elastic body: rotations, struts through the interior, the detail pass."""
