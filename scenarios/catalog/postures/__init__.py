"""Scripted postures at the edge of the possible: limits, reach cones, jumps, an avatar through itself."""
