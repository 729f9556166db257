"""Paths around obstacles that stall an avatar: RRT-Connect over certified steps, and the supervisor that drives the target."""
