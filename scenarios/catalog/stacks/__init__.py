"""Piles and stacks."""
