"""Live: a person in the loop, at a fixed rate, beside a page, ports and a recording (docs/live.md)."""
