"""A mesh in space: geometry, connectivity, repair, coarsening."""
