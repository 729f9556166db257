"""Readers of files: meshes, avatars, rooms and motions, as the types of `scene` and nothing else."""
