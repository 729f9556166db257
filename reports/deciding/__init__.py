"""Verdicts: which engine is best where, what held, what we lose. Rules and sentences, no layout."""
