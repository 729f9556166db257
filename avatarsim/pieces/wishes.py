"""Options of the convex decomposition, checked for type and range."""

from dataclasses import dataclass

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.checks import within

REPAIRS = ("auto", "remesh", "refuse")
"""What may be done about surfaces that cannot be mended as they are; `pieces_of_mesh` says what each means."""


@dataclass(frozen=True)
class Wishes:
    """Everything but the mesh that shapes the pieces, free of units, so that one cached answer serves every scale."""

    threshold: float = 0.05
    seed: int = 0
    most_vertices: int = 64
    most_pieces: int | None = None
    hull: bool = False
    repair: str = "auto"

    def __post_init__(self) -> None:
        object.__setattr__(self, "threshold", within("threshold of the decomposition", self.threshold, 0.01, 1.0, InvalidInput))
        whole("seed of the decomposition", self.seed, 0, 2**31 - 1)
        whole("most vertices of a piece", self.most_vertices, 8, 4096)
        if self.most_pieces is not None:
            whole("most pieces of a mesh", self.most_pieces, 1, 4096)
        if not isinstance(self.hull, bool):
            raise InvalidInput("whether a mesh becomes its hull", self.hull, "True or False")
        if self.repair not in REPAIRS:
            raise UnknownName("repair", self.repair, REPAIRS)


def whole(thing: str, value: object, low: int, high: int) -> int:
    """`value`, if it is a whole number from low to high."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidInput(thing, value, f"a whole number from {low} to {high}")
    return value
