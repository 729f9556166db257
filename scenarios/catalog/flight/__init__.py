"""Free flight, free rotation and a fall about one point."""
