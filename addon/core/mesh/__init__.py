"""A mesh in space: geometry, edges, connectivity, repair, coarsening."""
