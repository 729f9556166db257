"""Impulses and contact forces at one instant (Schmidl and Lin 2004, eqs 7 to 10): reads contacts, writes velocities."""
