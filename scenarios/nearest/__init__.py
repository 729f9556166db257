"""Nearest free posture by offline search: how close to the target sampled contact frames of a run could have been."""
