"""Charts of a run as Vega-Lite specifications."""
