"""Motion: paths of rigid bodies and their times of impact. Reads velocities, writes poses."""
