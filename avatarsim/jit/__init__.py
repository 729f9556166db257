"""Just-in-time compilation: where compiled kernels are kept, for which processors, and messages during compilation."""
