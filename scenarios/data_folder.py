"""Data files of installed packages, found without importing the package."""

from importlib.util import find_spec
from pathlib import Path

from avatarsim.errors import InvalidFile, MissingPackage


def _folder(package: str, distribution: str, extra: str, use: str) -> Path:
    """Return the folder of a package. Raises MissingPackage."""
    spec = find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise MissingPackage(distribution, extra, use)
    return Path(next(iter(spec.submodule_search_locations)))


def pybullet_data() -> Path:
    """Return the folder of humanoid, motion clips and meshes. Raises MissingPackage."""
    return _folder("pybullet_data", "pybullet_data", "compare", "reading the humanoid, its motions and the gallery's meshes")


def data_file(name: str) -> Path:
    """Return a file of that folder by its path in it. Raises InvalidFile."""
    path = pybullet_data() / name
    if not path.is_file():
        raise InvalidFile("file of pybullet_data", name, f"a file below {pybullet_data()}")
    return path


def robotics_assets() -> Path:
    """Return the folder of gymnasium-robotics' models. Raises MissingPackage."""
    return _folder("gymnasium_robotics", "gymnasium-robotics", "hand", "reading the articulated hand") / "envs" / "assets"
