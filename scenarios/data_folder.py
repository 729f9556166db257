"""Where an installed package keeps its data files, found without importing the package."""

from importlib.util import find_spec
from pathlib import Path

from avatarsim.errors import InvalidFile, MissingPackage


def pybullet_data() -> Path:
    """Folder of the package pybullet_data: humanoid, motion clips, meshes. MissingPackage when it is not there."""
    found = find_spec("pybullet_data")
    if found is None or not found.submodule_search_locations:
        raise MissingPackage("pybullet_data", "compare", "reading the humanoid, its motions and the gallery's meshes")
    return Path(next(iter(found.submodule_search_locations)))


def data_file(name: str) -> Path:
    """A file of that folder, by its path in it; InvalidFile when it is not there."""
    path = pybullet_data() / name
    if not path.is_file():
        raise InvalidFile("file of pybullet_data", name, f"a file below {path.parents[len(Path(name).parts) - 1]}")
    return path


def robotics_assets() -> Path:
    """Folder of gymnasium-robotics' models; MissingPackage when the package is not there."""
    found = find_spec("gymnasium_robotics")
    if found is None or not found.submodule_search_locations:
        raise MissingPackage("gymnasium-robotics", "hand", "reading the articulated hand")
    return Path(next(iter(found.submodule_search_locations))) / "envs" / "assets"
