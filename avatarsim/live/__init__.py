"""Live sessions: a person in the loop at a fixed rate, with a page, ports and a recording (docs/live.md)."""
