"""Scenes with bodies that move by themselves: lifts, belts, turntables, doors."""
