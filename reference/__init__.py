"""The comparison of avatarsim: an independent judge of overlap, exact answers, and other engines."""
