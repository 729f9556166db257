"""What a run leaves in its folder, and what its figures mean: read alike by the harness, the reports and the benchmarks."""
