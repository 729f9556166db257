"""Offline reference of closeness: sampled contact frames of a run beside the nearest free posture that a search finds."""
