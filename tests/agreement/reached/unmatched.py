"""What MuJoCo and PyBullet are known to reach and our adapters do not, or nothing here shows, and why."""

UNMATCHED = {
    "two threads, within a step or of several runs, are no faster":
        "runs here have one thread each, and the cores have runs of their own",
    "what is new in version 4 of MuJoCo, such as contacts that look ahead":
        "the version in use is 3.17, pinned; what figures are known of (the damper, DISCRETE, integrators that do not bounce, "
        "defaults) behaves alike in both, and is tested in 3.17",
}
"""What is known -> why it is not matched."""
