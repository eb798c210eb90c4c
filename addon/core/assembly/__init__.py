"""A mesh as pieces; bodies of several pieces, what rides on them, and bodies shared out and gathered."""
