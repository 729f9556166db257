"""Known properties of the packages in the pinned versions: their defaults, and that they work with numpy 2."""

import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

from reference.in_mujoco.presets import DEFAULT

ROOT = Path(__file__).resolve().parents[3]
WARNINGS = ("-W", "error::RuntimeWarning", "-W", "error::UserWarning")
"""Options that turn the warnings of a package built for another NumPy into errors."""
ONE_BALL = "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"


def test_mujoco_s_defaults_are_what_the_preset_of_that_name_says() -> None:
    model = mujoco.MjModel.from_xml_string(ONE_BALL)
    option = model.opt
    assert mujoco.mjtIntegrator(option.integrator).name == f"mjINT_{DEFAULT['integrator'].value}" == "mjINT_EULER"
    assert mujoco.mjtCone(option.cone).name == f"mjCONE_{DEFAULT['cone'].value}" == "mjCONE_PYRAMIDAL"
    assert mujoco.mjtSolver(option.solver).name == f"mjSOL_{DEFAULT['solver'].value}"
    for name, value in (
        ("timestep", "dt"), ("iterations", "iterations"), ("tolerance", "tolerance"), ("impratio", "impratio"),
        ("noslip_iterations", "noslip_iterations"),
    ):
        assert getattr(option, name) == DEFAULT[value].value
    assert model.geom_solref[0].tolist() == [DEFAULT["contact_time"].value, 1.0] == [0.02, 1.0]
    assert tuple(model.geom_solimp[0, :3]) == DEFAULT["solimp"].value
    assert model.geom_margin[0] == DEFAULT["margin"].value
    # several contacts per pair, its own collision of hulls, islands, warm starts and safe stiffness are all switched on
    assert option.disableflags == 0 and option.enableflags == 0


@pytest.mark.parametrize("package", ["mujoco", "pybullet", "coal", "fcl", "trimesh"])
def test_packages_are_imported_without_a_warning_beside_numpy_2(package: str) -> None:
    assert int(np.__version__.split(".")[0]) >= 2
    code = f"import importlib.util as u, numpy\nif u.find_spec({package!r}): import {package}"
    done = subprocess.run([sys.executable, *WARNINGS, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
