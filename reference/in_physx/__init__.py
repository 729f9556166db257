"""PhysX 5, by the package sapien, behind the Engine protocol."""
