"""The printed method, stage by stage: end effectors and goals, cyclic coordinate descent, attraction. Writes joint angles."""
