"""Collision detection: broad phase, signed distance, contact manifolds, time of impact. Reads poses, moves nothing."""
