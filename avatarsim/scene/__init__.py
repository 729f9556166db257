"""Description of the world: shapes, bodies, joints, avatars, materials, tracker samples, effects. Frozen and valid."""
