"""The wheel with the harness, and with compiled kernels if asked for:
`pip wheel . --no-build-isolation --no-deps -C--build-option=--with-kernels`.

The packages of the harness, which `avatarsim compare` runs, lie in the folder `_harness` of the package: their names are too
general for site-packages (avatarsim/comparing.py). All else about the package stands in pyproject.toml. Kernels are compiled by
the numba that is installed, for the processor baseline of avatarsim/jit/baseline.py; docs/installing.md says where such a wheel
serves.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.errors import ExecError

ROOT = Path(__file__).resolve().parent
HARNESS = ("runfiles", "reference", "scenarios", "reports")
"""Packages of the harness."""
LEFT_OUT = ("__pycache__", "*.pyc", "out", "pictures")
"""Files of no use in a wheel: runs of the checkout, and pictures of its README."""


class Wheel(bdist_wheel):
    """setuptools' wheel with the harness and one option more."""

    user_options = [*bdist_wheel.user_options, ("with-kernels", None, "carry compiled kernels, for one platform and Python")]
    boolean_options = [*bdist_wheel.boolean_options, "with-kernels"]

    def initialize_options(self) -> None:
        """Without kernels, unless told otherwise."""
        super().initialize_options()
        self.with_kernels = False

    def finalize_options(self) -> None:
        """Machine code makes the wheel one of a platform."""
        super().finalize_options()
        if self.with_kernels:
            self.root_is_pure = False

    def run(self) -> None:
        """Compile from the very files that the wheel holds, then pack these."""
        self.run_command("build")
        built = Path(self.get_finalized_command("build").build_lib).resolve()
        # An earlier wheel may have left its own.
        shutil.rmtree(built / "avatarsim" / "avatarsim-kernels", ignore_errors=True)
        add_harness(built)
        if self.with_kernels:
            compile_kernels(built)
        self.skip_build = True
        super().run()


def add_harness(built: Path) -> None:
    """Put the packages of the harness into the package in a folder."""
    target = built / "avatarsim" / "_harness"
    shutil.rmtree(target, ignore_errors=True)
    for name in HARNESS:
        shutil.copytree(ROOT / name, target / name, ignore=shutil.ignore_patterns(*LEFT_OUT))


def compile_kernels(built: Path) -> None:
    """Compile the kernels of the package in a folder into the package itself."""
    environment = os.environ | {"PYTHONPATH": str(built), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "avatarsim", "compile", "--to", str(built / "avatarsim")]
    if subprocess.run(command, env=environment, cwd=built, check=False).returncode != 0:
        raise ExecError("the kernels could not be compiled (the build needs numba, numpy and scipy: --no-build-isolation)")


setup(cmdclass={"bdist_wheel": Wheel})
