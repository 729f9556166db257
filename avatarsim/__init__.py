"""Contact between a driven avatar and its world, in real time, with nothing left overlapping."""

__version__ = "0.1.0"
