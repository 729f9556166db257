"""The contenders that take part. A library that is not installed is named and left out; the others run."""

from importlib import import_module

from avatarsim.errors import described
from reference.narrow_phase.contender import Contender

ROOMS = ("in_ours", "in_coal", "in_fcl", "in_mujoco", "in_pybullet")
"""Modules with a function `contenders`, ours first."""


def contenders(rooms: tuple[str, ...]) -> tuple[list[Contender], dict[str, str]]:
    """All contenders there are, and for each room that could not be opened the reason."""
    found: list[Contender] = []
    absent: dict[str, str] = {}
    for room in rooms:
        try:
            found += import_module(f"reference.narrow_phase.{room}").contenders()
        except Exception as error:
            # a broken installation of a library is its own result too
            absent[room.removeprefix("in_")] = f"not measured: {described(error)}"
    return found, absent
