"""Frame time against the number of links of one avatar, and of avatars in one scene; apart from everything, and in contact."""
