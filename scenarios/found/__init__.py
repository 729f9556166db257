"""What was found before and need not be found again: kept by content, so that only what changed is asked."""
