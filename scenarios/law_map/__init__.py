"""The measured map of the contact law: restitution and friction asked for against obtained, by engine, step and shape."""
