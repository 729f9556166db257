"""No file of the harness or the reports names another engine; only the engines' folders below `reference` do."""

import re
from itertools import chain
from pathlib import Path

from runfiles.engines import engines
from runfiles.naming import BASELINE, GATED

HOUSE = Path(__file__).resolve().parents[2]
ROOMS, KINDS = ("scenarios", "runfiles", "reports"), ("*.py", "*.js", "*.j2")
ALLOWED = {
    # a reason
    "scenarios/studies/contact_law/obtained.py",
    # the compiler of model files, which has their own geoms
    "scenarios/robots.py",
}


def test_only_the_folder_of_an_engine_names_it() -> None:
    others = [name for name in engines() if name not in (GATED[0], BASELINE)]
    # a package of recorded motions and models has the name of an engine at its beginning
    named = re.compile(f"({'|'.join(map(re.escape, others))})(?!_data)", re.IGNORECASE)
    files = chain.from_iterable((HOUSE / room).rglob(kind) for room in ROOMS for kind in KINDS)
    # runs stored in the checkout are not code
    own = (path.relative_to(HOUSE) for path in files if "out" not in path.relative_to(HOUSE).parts)
    found = {str(path) for path in own if named.search((HOUSE / path).read_text(encoding="utf-8"))}
    assert len(others) >= 2 and found <= ALLOWED, sorted(found - ALLOWED)
