"""How well meshes are matched: pairs of poses whose true match is known, by several ways to match."""
