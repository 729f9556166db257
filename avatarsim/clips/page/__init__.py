"""Self-contained pages of a folder of clips: a summary, and one page per clip that plays it before and after."""
