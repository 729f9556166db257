"""How long one narrow-phase query takes: ours and the libraries', on the same pairs, in turns, and how exact each is.

`python -m reference.narrow_phase` prints it and writes narrow_phase.csv, narrow_phase_cells.csv and narrow_phase.json.
"""
