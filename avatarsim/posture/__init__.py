"""Posture: reads contacts, writes joint angles."""
