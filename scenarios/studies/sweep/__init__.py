"""Work-precision sweep: every engine over a dozen of its own settings, in scenes that tell them apart; resumable by content."""
