"""Reads poses, writes contacts: sweep and prune, convex depth and distance, eq. 1; moves nothing."""
