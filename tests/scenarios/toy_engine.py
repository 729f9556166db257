"""An engine in its own package, with its files of facts: links have the tracker's poses."""

from pathlib import Path

ENGINE = """
from reference.in_tracker.engine import RawTracker

class Toy(RawTracker):
    name = "toy"
    version = "7.1"
    presets = ("default", "tuned")
"""
ABOUT = """
name = "toy"
label = "Toy Physics"
colour = "#123456"
dark = "#abcdef"
presets = ["tuned"]
packages = ["toy-physics"]
has_time_step = true

[variants.asleep]
scenes = "bodies may sleep"

[unsupported.dynamics]
metrics = ["apex_error_max"]
lacks = "engine"

[native]
dt = "toy.step({})"
"""
SWEEP = """
sweep = [
    { name = "tuned" },
    { base = "tuned", steps = [60, 240] },
    { name = "tuned sleep=true", short = false, options = { sleep = true, range = [0.5, 1.0] }, calls = ["sleeping"] },
]
"""


def laid(site: Path, about: str = ABOUT, sweep: str = SWEEP) -> Path:
    """Install the package in a folder, as pip would; return the package's folder."""
    info, package = site / "toy_physics-7.1.dist-info", site / "toy_physics" / "inner"
    for path, text in {
        info / "METADATA": "Metadata-Version: 2.1\nName: toy-physics\nVersion: 7.1\n",
        info / "entry_points.txt": "[avatarsim.engines]\ntoy = toy_physics.inner.adapter:Toy\n",
        package.parent / "__init__.py": "", package / "__init__.py": "", package / "adapter.py": ENGINE,
        package / "about.toml": about, package / "sweep.toml": sweep,
    }.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return package
