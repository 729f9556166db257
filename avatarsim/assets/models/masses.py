"""Masses of compiled bodies: inertia in body axes from principal moments, bodies combined by the parallel axis theorem.

A file may leave out masses, or round moments so that no solid has them; a link needs both (Featherstone 2008, 2.13).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.compiled import Compiled
from avatarsim.assets.models.spec_repairs import solid as solid_inertia
from avatarsim.scene.body import Mass, solid, volume
from avatarsim.scene.shape import Piece
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

LIGHTEST = 1e-9
"""Mass [kg] below which a body counts as without mass: a grain of dust."""

DENSITY = 1000.0
"""Density [kg/m^3] of a body that has pieces and no mass: that of water, and MuJoCo's own default."""

GRAM, CENTIMETRE = 1e-3, 1e-2
"""Mass [kg] and radius [m] of the ball used for a link without pieces and without mass."""


@dataclass(eq=False)
class Masses:
    """Masses of a model's bodies; `without` and `rounded` collect the names of those whose missing values were added."""

    model: Compiled
    names: Mapping[int, str]
    without: list[str] = field(default_factory=list)
    rounded: list[str] = field(default_factory=list)

    def nothing(self) -> Mass:
        """Return the mass of a link between two joints of one body."""
        return _ball()

    def of(self, bodies: Sequence[int], poses: Mapping[int, tuple[Array, Array]], pieces: tuple[Piece, ...]) -> Mass:
        """Return the mass of rigid `bodies` together, at `poses` (position (3,), turn (4,)) and with `pieces` in one frame."""
        heavy = [b for b in bodies if self.model.body_mass[b] > LIGHTEST]
        if not heavy:
            self.without.append(self.names[bodies[0]])
            return solid(pieces, DENSITY * sum(volume(piece.shape) for piece in pieces)) if pieces else _ball()
        masses = self.model.body_mass[heavy]
        centres = np.array([poses[b][0] + rotation.rotate(poses[b][1], self.model.body_ipos[b]) for b in heavy])
        total = float(masses.sum())
        centre = (masses[:, None] * centres).sum(axis=0) / total
        inertia = np.zeros((3, 3))
        for b, mass, at in zip(heavy, masses, centres - centre, strict=True):
            turn = rotation.to_matrix(rotation.multiply(poses[b][1], self.model.body_iquat[b]))
            moments = turn @ np.diag(self.model.body_inertia[b]) @ turn.T
            inertia += moments + mass * (at @ at * np.eye(3) - np.outer(at, at))
        x, y, z = (float(value) for value in centre)
        return Mass(total, (x, y, z), self._solid(inertia, total, self.names[bodies[0]]))

    def _solid(self, inertia: Array, mass: float, name: str) -> Array:
        """Return the nearest inertia that a solid can have: no moment above the sum of the others, none zero."""
        found, is_changed = solid_inertia(0.5 * (inertia + inertia.T), mass)
        if is_changed:
            self.rounded.append(name)
        return found

    def notes(self) -> tuple[str, ...]:
        """Return sentences on values of links and bodies that the file does not state."""
        found = []
        if self.without:
            found.append(f"without mass in the file, given that of water or of a gram: {', '.join(self.without)}")
        if rounded := dict.fromkeys((*self.model.mended_name, *self.rounded)):
            found.append(f"moments of inertia that no solid has, raised to what one can have: {', '.join(rounded)}")
        return tuple(found)


def _ball() -> Mass:
    return Mass(GRAM, inertia=0.4 * GRAM * CENTIMETRE**2 * np.eye(3))
