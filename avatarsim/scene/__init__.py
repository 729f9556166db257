"""What the world is: shapes, bodies, joints, avatars, materials, tracker samples, effects. Frozen and valid."""
