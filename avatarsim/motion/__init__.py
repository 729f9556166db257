"""Motion: reads velocities, writes poses."""
