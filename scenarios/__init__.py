"""What we ask of every engine: scenes, tracker motions, bounds. Knows no engine by name."""
