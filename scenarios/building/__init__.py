"""Parts of scenes: materials, floors, rooms, avatars, closed forms that are expected, promises that are shared."""
