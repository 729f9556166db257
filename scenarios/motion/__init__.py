"""Motions of the tracker: recorded clips, scripted postures, retimed, layered and resampled."""
