"""What avatarsim is compared with: an independent judge of overlap, exact answers, and other engines."""
