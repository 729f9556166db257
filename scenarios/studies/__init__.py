"""Short studies that are part of every comparison, and the sweep."""
