"""Who stays nearer to the user? Ours and another engine over the frames in which the other leaves next to no overlap."""
