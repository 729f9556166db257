"""Figures of simulated bodies: bounces, courses, conserved quantities, rest, sliding, spin and towers."""
