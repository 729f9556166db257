"""Driving: the user's intent for an avatar, by drags, keys, clips or a tracker, as one posture a frame."""
