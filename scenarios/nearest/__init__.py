"""How close could it have been? Sampled contact frames of a run beside the nearest free posture that offline search finds."""
