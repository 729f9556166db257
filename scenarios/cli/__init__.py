"""The commands of `python -m scenarios`. Alone here the harness and the reports meet."""
