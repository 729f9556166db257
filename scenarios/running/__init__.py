"""How engines are run and timed: jobs in processes of their own, one accuracy pass, one timing pass."""
