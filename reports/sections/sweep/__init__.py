"""Accuracy against time: points, fronts, the cheapest setting, ladders of steps, performance profiles."""
