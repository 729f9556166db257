"""Overlap removal of the paper's method (Schmidl and Lin 2004, Algorithm 1): reads contacts, writes poses."""
