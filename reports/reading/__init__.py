"""Readers of a run's files: results, recordings and scenes."""
