"""Distance of the shown avatar from its target, ours beside another engine's, over frames in which that one hardly overlaps."""
