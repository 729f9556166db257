"""Impact: reads contacts, writes velocities."""
