"""Scene graph of one engine in the page: room, bodies, avatar, contacts, a word at the avatar, and its user's ghost.

Retained mode (viser): a mesh is sent once, later only its pose. viser has no material without a depth test, so that the room
becomes translucent while the ghost, which is opaque, is apart from the avatar: opaque meshes are drawn first and stay visible.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from avatarsim.assets.models.pieces_of_geoms import Visual
from avatarsim.live.messages import State, Touching
from avatarsim.player.simplified import ROOM_TRIANGLES, visual_surfaces
from avatarsim.player.surfaces import Surface, corners, surface
from avatarsim.scene.body import Body as SceneBody
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Colour = tuple[int, int, int]

AVATARS: tuple[Colour, ...] = ((46, 134, 222), (230, 145, 56), (120, 94, 240), (0, 158, 115))
"""Avatars of the engines, the driven one first; distinct for colour-blind eyes (Okabe and Ito)."""
OVERLAPPING: Colour = (214, 39, 40)
"""Avatar or ghost that overlaps."""
FLASH: Colour = (255, 236, 140)
"""Avatar in the moment of an event."""
GHOST: Colour = (128, 128, 136)
"""Ghost that overlaps nothing."""
GLOW: Colour = (255, 196, 0)
"""Contacts."""
LOOSE: tuple[Colour, ...] = ((226, 184, 116), (205, 140, 92), (152, 176, 110))
"""Loose bodies, in turn."""
FLOOR: Colour = (140, 146, 154)
WALL: Colour = (200, 208, 216)
FURNITURE: Colour = (168, 128, 92)
DOOR: Colour = (112, 152, 160)
"""Fixed and moving bodies, all of a middle lightness, which suits a light and a dark page."""
FLAT, HIGH = 0.2, 1.2
"""Height of a floor, at most, as a share of its width; height of a wall [m], at least. Other fixed bodies are furniture."""
THROUGH = 0.35
"""Opacity of the room while the ghost is seen through it."""
APART = 4e-3
"""[m] between a link and its ghost from which the ghost is drawn. Less: the two flicker through each other."""
GLOWING = 0.03
"""Diameter of a contact's glow, as a share of the avatar's span."""
DRAW_INTERVAL = 1.0 / 30.0
"""[s] between two drawings. Shorter: drawing takes the time of the loop."""
FLASHING = 0.15
"""[s] of a flash."""


def colour_of(number: int) -> Colour:
    """Return the colour of the avatar of an engine, by its number."""
    return AVATARS[number % len(AVATARS)]


def room_colours(bodies: Sequence[SceneBody]) -> dict[str, Colour]:
    """Return colours that distinguish floor, walls and furniture, by the bodies' extents."""
    boxes = {}
    for body in bodies:
        points = np.concatenate([corners(piece) for piece in body.pieces]) if body.pieces else np.zeros((1, 3))
        points = rotation.rotate(np.asarray(body.orientation), points) + np.asarray(body.position)
        boxes[body.name] = points.min(axis=0), points.max(axis=0)
    ground = min((float(high[2]) for _, high in boxes.values()), default=0.0)
    found = {}
    for name, (low, high) in boxes.items():
        x, y, z = high - low
        is_floor = high[2] <= ground and z <= FLAT * min(x, y)
        found[name] = FLOOR if is_floor else WALL if z >= HIGH else FURNITURE
    return found


def surfaces_of(scene: Scene, visuals: Mapping[str, tuple[Visual, ...]]) -> dict[str, Surface]:
    """Return the surfaces that are drawn in place of pieces, by names of the scene, from its visuals."""
    names, first = scene.names, len(scene.bodies)
    return visual_surfaces(visuals, names[first:]) | visual_surfaces(visuals, names[:first], ROOM_TRIANGLES)


class Body:
    """A moving node: the mesh of the pieces or, of a body with a surface of its own, a frame with a mesh of each."""

    def __init__(
        self, server: viser.ViserServer, place: str, pieces: Sequence[Piece], seen: Surface | None, colour: Colour,
        visible: bool = True,
    ) -> None:
        def mesh(name: str, of: Surface) -> viser.MeshHandle:
            at = place if seen is None else f"{place}/{name}"
            return server.scene.add_mesh_simple(at, *of, color=colour, visible=visible or seen is not None)

        frame = None if seen is None else server.scene.add_frame(place, show_axes=False, visible=visible)
        self._tested = mesh("tested", surface(pieces)) if pieces else None
        self._seen = None if seen is None else mesh("seen", seen)
        self.meshes = [one for one in (self._seen, self._tested) if one is not None]
        self.node = frame or self.meshes[0]
        self.test(False)

    def place(self, position: Array, turn: Array) -> None:
        """Move it to a place (3,) [m] with orientation (4,)."""
        self.node.position, self.node.wxyz = position, turn

    def colour(self, colour: Colour) -> None:
        """Draw it in another colour."""
        for mesh in self.meshes:
            mesh.color = colour

    def fade(self, opacity: float | None) -> None:
        """Draw it translucent, or opaque for None."""
        for mesh in self.meshes:
            mesh.opacity = opacity

    def test(self, tested: bool) -> None:
        """Draw the pieces that are tested for overlap, or the surface."""
        if self._seen is not None:
            self._seen.visible = not tested
            if self._tested is not None:
                self._tested.visible = tested


class SceneMeshes:
    """The world of one engine as meshes, at `offset` (3,) [m] from that of the driven engine, which is number 0 and has the
    ghost. `seen`: surfaces drawn in place of pieces."""

    def __init__(
        self, server: viser.ViserServer, scene: Scene, name: str, number: int, seen: Mapping[str, Surface], offset: Array,
    ) -> None:
        self.number, self._first = number, len(scene.bodies)
        self._frame = server.scene.add_frame(f"/{name}", show_axes=False, position=offset)
        names, links = scene.names, [link for avatar in scene.avatars for link in avatar.links]
        fixed = [body for body in scene.bodies if body.role is Role.FIXED]
        colours = room_colours(fixed)
        self._room = [
            Body(server, f"/{name}/room/{body.name}", body.pieces, seen.get(body.name), colours[body.name]) for body in fixed
        ]
        for body, node in zip(fixed, self._room, strict=True):
            node.place(np.asarray(body.position), np.asarray(body.orientation))
        loose = [k for k, body in enumerate(scene.bodies) if body.role is Role.SIMULATED]
        self.moving = {
            k: Body(server, f"/{name}/{names[k]}", scene.bodies[k].pieces, seen.get(names[k]), LOOSE[at % len(LOOSE)])
            for at, k in enumerate(loose)
        }
        shown = {k: link.pieces for k, link in enumerate(links, self._first) if link.pieces or names[k] in seen}
        driven = range(self._first, self._first + len(scene.avatars[0].links))
        self.links = {
            k: Body(server, f"/{name}/{names[k]}", pieces, seen.get(names[k]), colour_of(number) if k in driven else DOOR)
            for k, pieces in shown.items()
        }
        self._avatar = [body for k, body in self.links.items() if k in driven]
        self.ghost = {
            k: Body(server, f"/{name}/ghost/{names[k]}", pieces, seen.get(names[k]), GHOST, visible=False)
            for k, pieces in shown.items() if number == 0 and k in driven
        }
        self._line = server.scene.add_line_segments(
            f"/{name}/line", np.zeros((1, 2, 3)), OVERLAPPING, thickness=3.0, thickness_units="screen", visible=False
        )
        self._glow = server.scene.add_point_cloud(
            f"/{name}/contacts", np.zeros((1, 3)), GLOW, point_size=GLOWING * scene.avatars[0].span, point_shape="sparkle",
            precision="float32", visible=False,
        )
        self._above = 0.3 * scene.avatars[0].span
        self._word = server.scene.add_label(
            f"/{name}/word", "", font_screen_scale=1.6, anchor="bottom-center", visible=False
        )
        self._is_ghost_wanted, self._overlaps, self._flash_end, self._touched = True, False, 0.0, -1
        self._is_through, self._ghost_overlaps, self._colour = False, False, colour_of(number)

    @property
    def colour(self) -> Colour:
        """Colour of its avatar without overlap."""
        return colour_of(self.number)

    def show(self, state: State, touching: Touching | None, now: float) -> None:
        """Move everything to its pose in a state; `now` [s] ends flashes."""
        for group in (self.moving, self.links):
            for k, body in group.items():
                body.place(state.positions[k], state.orientations[k])
        self._word.position = state.positions[self._first] + (0.0, 0.0, self._above)
        colour = OVERLAPPING if self._overlaps else FLASH if now < self._flash_end else self.colour
        if colour != self._colour:
            self._colour = colour
            for body in self._avatar:
                body.colour(colour)
        if touching is not None and touching.frame != self._touched:
            self._touched, points = touching.frame, touching.contacts[:, :3]
            self._glow.visible = len(points) > 0
            if len(points):
                self._glow.points = points.astype(np.float32)

    def show_ghost(self, positions: Array, orientations: Array, state: State) -> float:
        """Move the ghost to the poses of all links, (links, 3) [m] and (links, 4), and draw the links that are apart from those
        of a state. Returns the largest distance [m]."""
        if not self.ghost:
            return 0.0
        ks = np.array(list(self.ghost))
        gaps = np.linalg.norm(positions[ks - self._first] - state.positions[ks], axis=1)
        farthest = int(ks[np.argmax(gaps)])
        is_apart = bool(gaps.max() > APART) and self._is_ghost_wanted
        for k, gap in zip(ks.tolist(), gaps.tolist(), strict=True):
            self.ghost[k].node.visible = is_apart and gap > 0.5 * APART
            if is_apart:
                self.ghost[k].place(positions[k - self._first], orientations[k - self._first])
        self._line.visible = is_apart
        if is_apart:
            self._line.points = np.array([[positions[farthest - self._first], state.positions[farthest]]], dtype=np.float32)
        return float(gaps.max())

    def mark(self, overlaps: bool, ghost_overlaps: bool) -> None:
        """Draw avatar and ghost red while they overlap."""
        self._overlaps = overlaps
        if ghost_overlaps != self._ghost_overlaps:
            self._ghost_overlaps = ghost_overlaps
            for body in self.ghost.values():
                body.colour(OVERLAPPING if ghost_overlaps else GHOST)

    def see_through(self, apart: float) -> None:
        """Draw the room translucent while a ghost is `apart` [m] from its avatar."""
        if (is_through := apart > APART) != self._is_through:
            self._is_through = is_through
            for body in self._room:
                body.fade(THROUGH if is_through else None)

    def show_word(self, word: str, flash_end: float = 0.0) -> None:
        """Show a word at the avatar, none for an empty one, and let the avatar flash until a time [s]."""
        if word:
            self._word.text = word
        self._word.visible, self._flash_end = bool(word), max(self._flash_end, flash_end)

    def see_ghost(self, visible: bool) -> None:
        """Draw the ghost, or not."""
        self._is_ghost_wanted = visible

    def test(self, tested: bool) -> None:
        """Draw the pieces that are tested for overlap, or the surfaces."""
        for body in (*self._room, *self.moving.values(), *self.links.values(), *self.ghost.values()):
            body.test(tested)

    def remove(self) -> None:
        """Remove all its nodes from the page."""
        self._frame.remove()
