"""What every child of the harness needs of the project, imported once by their mother.

A module at fault is left to the child that needs it, which fails where it is used and says so.
"""

from contextlib import suppress
from importlib import import_module

NEEDED = ("scenarios.catalog", "scenarios.run", "scenarios.timing", "reference.judge")
"""The harness and the judge; importing them takes a child half a second, and a comparison has hundreds of children."""

for name in NEEDED:
    with suppress(Exception):
        import_module(name)
with suppress(Exception):
    # reads every source file; each child would do it again
    import_module("scenarios.provenance").code_hash()
