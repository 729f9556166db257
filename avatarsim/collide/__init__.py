"""Collision detection: broad phase, signed distance of convex shapes, global depth (eq. 1). Reads poses, moves nothing."""
