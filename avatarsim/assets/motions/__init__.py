"""Motions from files and back: BVH, ASF with AMC, arrays of coordinates, and the 44 columns of DeepMimic."""
