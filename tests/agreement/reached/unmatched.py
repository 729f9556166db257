"""What MuJoCo and PyBullet are known to reach and our adapters do not, or nothing here shows, and why."""

UNMATCHED = {
    "seen at the surface, restitution 1 is 1.035 at 1/60":
        "g dt / v is 0.037 there, and which phases are drawn moves the others by 0.01: compared from 1/240 on",
    "frame times, and what each setting costs":
        "they are a machine's: rows of the sweep, of bench.csv and of the narrow phase show today's, side by side",
    "Python costs MuJoCo's loop 3 %":
        "bench.csv has a column of time outside the engine's step instead, which holds all of the adapter",
    "step threads, solver variants, islands, warm starts and cone switches change nothing":
        "not swept: a row that shows nothing costs a reader as much as one that does",
    "getState, setState and rollout of MuJoCo continue bit for bit, PyBullet's saveState does not":
        "no adapter uses them: runs are repeated from their start",
    "facts about the packages of version 4":
        "the version in use is 3.17, pinned; the damper, DISCRETE and the integrators that do not bounce behave alike in both",
}
"""What is known -> why it is not matched."""
