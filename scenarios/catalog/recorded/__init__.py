"""Scenes in which a humanoid follows recorded motion."""
