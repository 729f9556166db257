"""Rapier as an expert would run it on our scenes: at its documented defaults, and tuned."""

import os

# one core, as other engines: on busy cores a second thread is waited for; `set_num_threads(1)` hands each step to another thread
os.environ.setdefault("RAYON_NUM_THREADS", "1")
