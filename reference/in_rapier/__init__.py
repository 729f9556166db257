"""Rapier as an expert would run it on our scenes: at its documented defaults, and tuned."""
