"""Benchmark of engines: scenes, tracker motions and bounds, the same for all. Knows no engine by name."""
