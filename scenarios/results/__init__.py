"""What a run keeps, where it comes from, what the gate says of it, and what need not be found again."""
