"""What did a run leave, and is it whole? Typed rows, recordings, scenes."""
