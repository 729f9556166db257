"""Avatars and rooms from files: MJCF and URDF by MuJoCo's compiler, meshes by their convex pieces."""
