"""Just-in-time compilation: where compiled kernels are kept, for which processors, and what is said while they are compiled."""
