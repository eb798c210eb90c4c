"""The mesh as an elastic body: rotations, twists of limbs, struts through the interior, the detail pass."""
