"""The page of a live session, by viser: drawing, panel, and actions of pointer and keys (extra `view`)."""
