"""Separates: reads contacts, writes poses."""
