"""Figures of a shown avatar: its joints, their limits, how far it is from its target, how smoothly it moves."""
