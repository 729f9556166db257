"""Reading of a run's files: typed rows, recordings, scenes, and whether they are whole."""
