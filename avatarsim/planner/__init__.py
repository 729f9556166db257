"""Paths around what an avatar is stalled by: RRT-Connect over certified steps, and the supervisor that drives the target."""
