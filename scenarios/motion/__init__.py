"""What the tracker shows: recorded clips, scripted postures, retimed, layered and resampled."""
