"""The avatars that scenes use: a humanoid read from its file, a rigid hand of fifteen parts."""
