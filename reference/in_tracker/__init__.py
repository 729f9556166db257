"""The raw tracker as an engine: no contact handling."""
