"""Figures taken from a recording, one family per file; pure functions that never call an engine."""
