"""Scenes played again in a browser, and what happened over their time."""
