"""What is said of the engines names the versions that are installed."""

import re
from importlib.metadata import PackageNotFoundError, version

import pytest

from reports.page.index import FAIRNESS
from runfiles.explained import EXPLAINED, PINNED

NAMES = {"MuJoCo": "mujoco", "PyBullet": "pybullet"}


@pytest.mark.parametrize("engine", NAMES)
def test_versions_in_sentences_are_those_that_run(engine: str) -> None:
    try:
        installed = version(NAMES[engine])
    except PackageNotFoundError:
        pytest.skip(f"{engine} is not installed")
    told = {found for rule in EXPLAINED for found in re.findall(rf"{engine} (\d+\.\d+(?:\.\d+)?)", rule.why.sentence)}
    assert told and all(f"{installed}.".startswith(f"{found}.") for found in told), told


def test_what_tunnels_names_the_version_that_does_and_the_page_that_there_is_a_newer_one() -> None:
    tunnels = [rule.why.sentence for rule in EXPLAINED if re.search("tunnels|ends of steps", rule.why.sentence)]
    assert tunnels and all("MuJoCo 3.17" in sentence for sentence in tunnels)
    assert PINNED in FAIRNESS and "3.17.0" in PINNED and "4.0.0" in PINNED and "speculative" in PINNED
