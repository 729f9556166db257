"""Scripted postures at the edge of what is possible: limits, reach cones, jumps, an avatar through itself."""
