"""`index.html` and the pages of scenes."""
