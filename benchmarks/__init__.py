"""Measurements of single algorithms and of growth, each beside other methods: `python -m benchmarks NAME`."""
