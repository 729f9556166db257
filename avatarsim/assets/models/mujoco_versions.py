"""Versions of MuJoCo that can be used: two distributions bring the package `mujoco`, and one version is at fault."""

from importlib import metadata

from avatarsim.errors import UnsupportedVersion

DISTRIBUTIONS = ("mujoco", "mujoco-core")
"""Both install into the folder `mujoco/`. From 4.0 on the first is a shell that requires the second in the same version."""
FAULTY = {"4.0.0": "its Newton solver factors sparse Hessians wrongly: accelerations are off, unsaid"}
"""Versions that compute wrong motion, and why. Their compiler reads files as others do."""


def installed() -> dict[str, str]:
    """Return the version of each distribution that is installed."""
    found = {}
    for name in DISTRIBUTIONS:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def check_folder() -> None:
    """Raise UnsupportedVersion where the distributions have overwritten each other: the package fails to import, or is a mix."""
    found = installed()
    if len(set(found.values())) > 1:
        both = " and ".join(f"{name} {version}" for name, version in found.items())
        raise UnsupportedVersion(
            f"{both} share the folder mujoco/, and each has overwritten files of the other: "
            "`pip uninstall mujoco mujoco-core`, then install one of them"
        )


def check_motion() -> None:
    """Raise UnsupportedVersion as `check_folder`, and where the installed version computes wrong motion."""
    check_folder()
    for version in installed().values():
        if version in FAULTY:
            raise UnsupportedVersion(f"MuJoCo {version}: {FAULTY[version]}; install mujoco==3.17.0 or mujoco-core>=4.0.1")
