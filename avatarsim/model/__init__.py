"""Model and state: the scene as arrays, constant ones and those that frames change."""
