"""Does the order in which chains are treated matter? One scene, one motion, a hundred orders, and how far the frames spread."""
