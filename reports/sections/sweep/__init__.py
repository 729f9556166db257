"""Work-precision sweep: points, fronts, the cheapest setting, ladders of steps, performance profiles."""
