"""Tables of a run: what pages, summaries and the terminal show, as pandas frames."""
