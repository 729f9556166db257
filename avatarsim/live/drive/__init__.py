"""Driving: what a user wants an avatar to do, by drags, keys, clips or a tracker, as one posture a frame."""
