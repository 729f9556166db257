"""A driven hand or ball against walls and things."""
