"""What is drawn of a session: the room once, what moves at each draw, the user's own posture as a ghost, contacts as normals.

Retained-mode scene graph (viser): a mesh is sent once, later only where it is.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from avatarsim.live.messages import State, Touching
from avatarsim.player.surfaces import Surface, surface
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece

Array = NDArray[np.float64]
Colour = tuple[int, int, int]

SHOWN: tuple[Colour, ...] = ((46, 134, 222), (230, 145, 56), (120, 94, 240), (0, 158, 115))
"""Of the avatar as each engine shows it, the driven one's first: apart for all eyes (Okabe and Ito)."""
OVERLAPPING: Colour = (214, 39, 40)
"""Of an avatar that overlaps more than a micrometre."""
LOOSE: Colour = (196, 160, 110)
"""Of bodies that are loose."""
ROOM: dict[bool, Colour] = {False: (205, 208, 212), True: (88, 94, 104)}
"""Of what is fixed, by whether the page is dark."""
GHOST: dict[bool, Colour] = {False: (90, 90, 90), True: (220, 220, 220)}
"""Of the user's own posture."""
FAINT, BESIDE = 0.25, 0.55
"""How opaque the ghost is, and bodies of engines beside the driven one."""
NORMAL = 0.05
"""Length of a drawn normal [m]."""
CONTACT: Colour = (214, 39, 140)
"""Of normals."""


def colour_of(number: int) -> Colour:
    """Of the avatar of an engine, by its place among them."""
    count = len(SHOWN)
    return SHOWN[number % count]


class Body:
    """A node that moves: the mesh of the pieces, or, of a body with a surface of its own, a frame with a mesh of each."""

    def __init__(
        self, server: viser.ViserServer, place: str, pieces: Sequence[Piece], seen: Surface | None, colour: Colour,
        opacity: float | None,
    ) -> None:
        def mesh(name: str, of: Surface) -> viser.MeshHandle:
            at = place if seen is None else f"{place}/{name}"
            return server.scene.add_mesh_simple(at, *of, color=colour, opacity=opacity, flat_shading=False)

        frame = None if seen is None else server.scene.add_frame(place, show_axes=False)
        self._tested = mesh("tested", surface(pieces)) if pieces else None
        self._seen = None if seen is None else mesh("seen", seen)
        self.meshes = [one for one in (self._seen, self._tested) if one is not None]
        self.node = frame or self.meshes[0]
        self.test(False)

    def place(self, position: Array, turn: Array) -> None:
        """Move it to a place (3,) [m], turned by (4,)."""
        self.node.position, self.node.wxyz = position, turn

    def colour(self, colour: Colour) -> None:
        """Draw it in another colour."""
        for mesh in self.meshes:
            mesh.color = colour

    def test(self, tested: bool) -> None:
        """Draw the pieces that are tested, or the surface."""
        if self._seen is not None:
            self._seen.visible = not tested
            if self._tested is not None:
                self._tested.visible = tested


class Drawn:
    """Meshes of one engine's state: links, and loose bodies; the room only for the driven one, the ghost likewise. `seen` has the
    surfaces that are drawn in place of pieces."""

    def __init__(self, server: viser.ViserServer, scene: Scene, name: str, number: int, seen: Mapping[str, Surface]) -> None:
        self._scene, self._name, self._number = scene, name, number
        self._is_driven = number == 0
        self._first = len(scene.bodies)
        self._links = [link for avatar in scene.avatars for link in avatar.links]
        names = scene.names
        self._room = {
            body.name: Body(server, f"/room/{body.name}", body.pieces, seen.get(body.name), ROOM[False], None)
            for body in scene.bodies if self._is_driven and body.role is Role.FIXED
        }
        for body in scene.bodies:
            if body.name in self._room:
                self._room[body.name].place(np.asarray(body.position), np.asarray(body.orientation))
        opacity = None if self._is_driven else BESIDE
        loose = LOOSE if self._is_driven else colour_of(number)
        self.moving = {
            k: Body(server, f"/{name}/{names[k]}", body.pieces, seen.get(names[k]), loose, opacity)
            for k, body in enumerate(scene.bodies) if body.role is Role.SIMULATED
        }
        shown = {k: link.pieces for k, link in enumerate(self._links, self._first) if link.pieces or names[k] in seen}
        self.links = {
            k: Body(server, f"/{name}/{names[k]}", pieces, seen.get(names[k]), self.colour, opacity)
            for k, pieces in shown.items()
        }
        self._ghost = {
            k: Body(server, f"/ghost/{names[k]}", pieces, seen.get(names[k]), GHOST[False], FAINT)
            for k, pieces in shown.items() if self._is_driven
        }
        self._normals = server.scene.add_line_segments(
            f"/{name}/normals", np.zeros((1, 2, 3)), CONTACT, thickness=3.0, thickness_units="screen"
        ) if self._is_driven else None
        self._overlaps, self._touched = False, -1

    @property
    def colour(self) -> Colour:
        """Of its avatar, where nothing overlaps."""
        return colour_of(self._number)

    def show(self, state: State, touching: Touching | None) -> None:
        """Move everything to where a state has it."""
        for group in (self.moving, self.links):
            for k, body in group.items():
                body.place(state.positions[k], state.orientations[k])
        if self._normals is not None and touching is not None and touching.frame != self._touched:
            self._touched = touching.frame
            points, normals = touching.contacts[:, :3], touching.contacts[:, 3:]
            # one segment at least, without length, for the node is never taken away
            segments = np.stack([points, points + NORMAL * normals], axis=1) if len(points) else np.zeros((1, 2, 3))
            self._normals.points = segments.astype(np.float32)

    def show_ghost(self, positions: Array, orientations: Array) -> None:
        """Move the ghost to the poses of all links, (links, 3) [m] and (links, 4)."""
        for k, body in self._ghost.items():
            body.place(positions[k - self._first], orientations[k - self._first])

    def mark(self, overlaps: bool) -> None:
        """Draw the avatar red while it overlaps."""
        if overlaps != self._overlaps:
            self._overlaps = overlaps
            for body in self.links.values():
                body.colour(OVERLAPPING if overlaps else self.colour)

    def see(self, visible: bool) -> None:
        """Draw it, or not."""
        for body in (*self.moving.values(), *self.links.values()):
            body.node.visible = visible

    def see_ghost(self, visible: bool) -> None:
        """Draw the ghost, or not."""
        for body in self._ghost.values():
            body.node.visible = visible

    def test(self, tested: bool) -> None:
        """Draw the pieces that are tested for overlap, or the surfaces."""
        for group in (self._room, self.moving, self.links, self._ghost):
            for body in group.values():
                body.test(tested)

    def darken(self, dark: bool) -> None:
        """Colours for a dark page, or for a light one."""
        for body in self._room.values():
            body.colour(ROOM[dark])
        for body in self._ghost.values():
            body.colour(GHOST[dark])
