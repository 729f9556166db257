"""The sections of index.html, one question each."""
