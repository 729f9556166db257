"""Measurements of single algorithms and of growth, each compared with other methods: `python -m benchmarks NAME`."""
