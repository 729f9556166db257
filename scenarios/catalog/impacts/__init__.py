"""Impacts with a closed form or a conserved quantity."""
