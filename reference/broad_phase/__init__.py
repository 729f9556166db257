"""What sweep and prune costs per object, from 20 to 20,000 objects at a fixed number of near pairs.

`python -m reference.broad_phase` prints it and writes broad_phase.csv.
"""
