"""The page of a live session, by viser: what is drawn, the panel beside it, and what a pointer and keys do (extra `view`)."""
