"""Files of a run and the meaning of their figures, for the harness, the reports and the benchmarks."""
