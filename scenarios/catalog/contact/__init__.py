"""Sustained contact: crowds of loose bodies, and hands that carry, press, push and sweep them."""
