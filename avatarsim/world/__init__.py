"""The scene as arrays: what never changes, and the state that does."""
