"""Figures of simulated bodies: bounces, courses, conserved quantities, what rests, slides, spins and stands."""
