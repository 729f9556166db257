"""Tasks that run side by side: in processes of this machine, or on the machines of a cluster."""
