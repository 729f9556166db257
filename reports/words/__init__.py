"""Numbers, metrics and text as a reader has them."""
