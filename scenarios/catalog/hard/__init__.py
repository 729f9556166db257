"""Scenes that are hard on purpose: where engines are known to fail."""
