"""Target posture of an avatar for each frame, from drags, keys, clips or trackers, one source at a time.

Shared control by precedence: a drag comes before keys, keys before a clip, a clip before a tracker. The posture is continuous
through every change of source: driving by hand continues from the shown posture, and clips and trackers are blended in by an
offset that decays (inertialization, Bollo 2016). Obstacles are not known here; the engine keeps the avatar out of them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate
from math import hypot

import numpy as np
from numpy.typing import ArrayLike

from avatarsim.errors import InvalidInput, InvalidSample, UnknownName
from avatarsim.live.drive.ease import STEEPNESS, Offset, largest_turn, minimum_jerk, mixed, pulse, shortened
from avatarsim.live.drive.gait import Gait, yaw_of_x
from avatarsim.live.drive.keys import BY_NAME, KEYS, Speeds
from avatarsim.live.drive.limbs import closing, fingers_of, limbs_of
from avatarsim.live.drive.pull import Goal, Pull
from avatarsim.live.drive.tree import Array, Posture, Tree, posture_of
from avatarsim.scene.checks import bounded, unit_quaternion, vector, within
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import with_moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial.rotation import difference, rotate, turned

__all__ = ["KEYS", "Driver"]

FASTEST, FASTEST_TURN = 2.5, 8.0
"""Largest speeds of driving by hand: of a root and of a dragged link [m/s], of a joint against its parent [rad/s].
A quick hand reaches twice that; more: a link that is pulled through a wall moves too far in a frame to be seen."""

FARTHEST = 100.0
"""[m] Largest distance of a gizmo's goal from the avatar's root."""

LONGEST_TICK = 1.0
"""[s] Longest tick, equal to the engine's longest frame."""

PATIENCE = 0.1
"""[s] of stalling after which the root covers all of a limb's missing distance. Less: roots move for goals within reach."""

LIFTING, HIGHEST = 0.5, 1.5
"""[m/s] of the lift keys, and [m] that moving bodies rise above their first places: half a storey in three seconds."""

TURNING = 1.5
"""[rad/s] of the turn keys: half a turn in two seconds."""

CLOSING, REACHING, STRIKE = 0.5, 0.6, 0.3
"""[s] Shortest times: to close a fist, to reach out with the arms, and of a flick."""

STRIKE_SHARE, STRIKE_WAY = 0.6, 0.15
"""Length of a flick: as a share of the way to the reached-out arm, and of the avatar's span if it has no arms."""

LEVER = 0.1
"""Length of a turn of a radian, as a share of the avatar's span: about a hand's length in a human."""


@dataclass
class _Drag:
    """A dragged link: the place of its gizmo, and the progress of the pull."""

    goal: Array
    turn: Array | None
    at: Array
    turned: Array


@dataclass
class _Clip:
    motion: Motion
    shift: Array
    time: float = 0.0


@dataclass
class _Swing:
    """Joints moving from one posture to another, by a course over the time `length` [s]."""

    start: Posture
    end: Posture
    links: list[int]
    length: float
    course: Callable[[float], float] = minimum_jerk
    age: float = 0.0


class Driver:
    """Drives the first avatar of a scene; links of others move only when dragged, or by a tracker.

    Raises InvalidInput for a scene without an avatar. Equal calls in equal order give equal bits."""

    def __init__(self, scene: Scene) -> None:
        if not scene.avatars:
            raise InvalidInput("avatars of the scene to drive", 0, "at least 1")
        self._scene, self._tree = scene, Tree(scene.avatars)
        names = scene.names[len(scene.bodies):]
        self._index = {name: k for k, name in enumerate(names)}
        self._first = len(scene.avatars[0].links)
        self._span = scene.avatars[0].span if any(link.pieces for link in scene.avatars[0].links) else 1.0
        self._start = posture_of(checked(scene.first_sample, scene.avatars))
        limbs = limbs_of(self._tree, self._start)
        self._arms = limbs.arms
        self._gait = Gait(self._tree, limbs.legs, self._start, LEVER * self._span) if limbs.legs else None
        own = tuple(one for one in fingers_of(self._tree) if self._tree.nodes[one.hand].avatar == 0)
        self._closing = closing(self._tree, own)
        self._lifts = [
            k for k, node in enumerate(self._tree.nodes) if node.is_free and scene.avatars[node.avatar].moves
        ]
        self._pulls: dict[tuple[int, ...], Pull] = {}
        self._stalls: dict[tuple[int, ...], float] = {}
        self._arm_joints = [k for arm in self._arms for k in self._tree.moving(arm.links)]
        self._reached = self._reached_out()
        self._time = 0.0
        self.reset()

    def reset(self) -> None:
        """Return to the start of the scene; time continues."""
        self._base, self._shown = self._start.copy(), self._start.copy()
        self._speeds, self._drags = Speeds(), dict[int, _Drag]()
        self._stalls.clear()
        self._clip: _Clip | None = None
        self._tracker: Posture | None = None
        self._is_fresh = self._is_reached = self._was_moved = False
        self._offset: Offset | None = None
        self._swing: _Swing | None = None
        self._source = "still"
        if self._gait is not None:
            self._gait.end()

    @property
    def source(self) -> str:
        """Source of the last posture: "drag", "keys", "clip", "tracker", or "still" if nothing moves it."""
        return self._source

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links that can be dragged, as in the scene."""
        return tuple(self._index)

    @property
    def period(self) -> float:
        """[s] of two steps of the walk; 0 for an avatar without legs, which glides."""
        return 0.0 if self._gait is None else self._gait.period

    def pose(self, link: str) -> tuple[Array, Array]:
        """Return the position [m] and orientation of a link's joint in the last posture. Raises UnknownName."""
        return self._tree.pose(self._shown, self._number(link))

    # --- actions of the user

    def drag(self, link: str, position: ArrayLike, orientation: ArrayLike | None = None) -> None:
        """Pull the joint of a link to `position` (3,) [m] and, unless None, turn it to `orientation` (4,), until `release`.

        Root links move as a whole. Others pull along the chain up to the root; the root itself follows if the goal is out of
        reach. Raises UnknownName, and InvalidSample for values that are not finite, no rotation, or farther than `FARTHEST`."""
        k = self._number(link)
        goal = _vector(f"goal of {link} [m]", position)
        root = self._tree.pose(self._shown, self._tree.chain(k)[0])[0]
        bounded(f"way from the root to the goal of {link} [m]", (goal - root).tolist(), FARTHEST, InvalidSample)
        given = None if orientation is None else np.asarray(orientation, dtype=object).tolist()
        turn = None if given is None else np.array(unit_quaternion(f"orientation of the goal of {link}", given, InvalidSample))
        if k in self._drags:
            self._drags[k].goal, self._drags[k].turn = goal, turn
            return
        self._switch_source("drag")
        place, turned = self._tree.pose(self._base, k)
        self._drags[k] = _Drag(goal, turn, place, turned)

    def release(self, link: str) -> None:
        """Release a link, which stays where it is; no effect on a link that is not dragged. Raises UnknownName."""
        self._drags.pop(self._number(link), None)
        self._stalls.clear()

    def press(self, key: str) -> str:
        """Press or repeat a key of `KEYS`. Return "", or the reason why it has no effect. Raises UnknownName."""
        if key not in BY_NAME:
            raise UnknownName("key", str(key), BY_NAME)
        pressed, axis = BY_NAME[key], BY_NAME[key].axis
        if axis == "fist" and not self._closing:
            return "this avatar has no fingers with hinges, so that there is no fist to open or close"
        if axis == "lift" and not self._lifts:
            return "nothing in this scene moves by itself, so that there is no lift"
        if key == "t" and not self._arms:
            return "this avatar has no pair of arms, so that none reaches out"
        if not self._tree.nodes[0].is_free and (axis and axis not in ("fist", "lift") or key == " " and not self._arms):
            return "the root of this avatar is not free, so that it stays where it is"
        if self._drags:
            return "a link is being dragged, which goes before keys"
        self._switch_source("keys")
        if axis:
            self._speeds.press(axis, pressed.sign)
        elif key == "t":
            self._is_reached = not self._is_reached
            self._swing = self._towards(self._reached if self._is_reached else self._start)
        elif self._swing is None:
            self._swing = self._flick()
        return ""

    def play(self, motion: Motion, at: ArrayLike | None = None) -> None:
        """Play a motion of the first avatar, or of the first few, from its beginning; `at` (3,) [m]: start of its root, None
        for the recorded one.

        It ends at its last frame, with `take_over`, or when a drag or a key takes over. Raises InvalidSample if its links or
        hinges do not match the avatar's, its rotations are not of length 1, or `at` is not a finite point."""
        avatars = self._scene.avatars
        links = list(accumulate(len(one.links) for one in avatars))
        hinges = list(accumulate(one.hinge_count for one in avatars))
        if motion.positions.shape[1] not in links:
            raise InvalidSample("links of the motion", motion.positions.shape[1], f"{links[0]}, as the avatar has")
        if motion.angles.shape[1] != hinges[links.index(motion.positions.shape[1])]:
            raise InvalidSample("hinges of the motion", motion.angles.shape[1], f"{hinges[0]}, as the avatar has")
        lengths = np.linalg.norm(motion.rotations, axis=2)
        if not (np.abs(lengths - 1.0) <= 1e-6).all():
            frame = int(np.argmax(np.abs(lengths - 1.0).max(axis=1)))
            raise InvalidSample(f"rotations of frame {frame} of the motion", motion.rotations[frame].tolist(), "of length 1")
        own = np.asarray(motion.positions[0, 0], dtype=np.float64)
        begin = own if at is None else _vector("place where a motion begins [m]", at)
        bounded("place where the root of a motion begins [m]", begin.tolist(), 1e6, InvalidSample)
        self._drags.clear()
        self._switch_source("clip")
        self._clip = _Clip(motion, begin - own)
        self._offset = self._offset_to(self._of_clip(self._clip))

    def take_over(self) -> None:
        """End a clip: driving by hand continues from its current posture."""
        if self._clip is not None:
            self._switch_source("keys")
            self._source = "still"

    def set_sample(self, sample: TrackerSample) -> None:
        """Set the newest posture from a tracker, of all avatars or of all but moving bodies; it applies while no other source
        goes first, within the joints' limits.

        Raises InvalidSample if it is not finite, does not fit the avatars, or is no rotation; the previous one then stays."""
        sample = with_moving(self._scene.avatars, sample, {}, self._base.sample(self._time))
        sample = checked(sample, self._scene.avatars)
        if not (np.abs(sample.positions) <= 1e6).all():
            raise InvalidSample("tracker positions [m]", float(np.abs(sample.positions).max()), "components up to 1e6")
        self._tracker, self._is_fresh = self._tree.clip(posture_of(sample)), True

    def tick(self, dt: float) -> TrackerSample:
        """Advance by `dt` [s] and return the posture of all avatars. Raises InvalidInput for an invalid frame time."""
        dt = within("time of a tick [s]", dt, 1e-6, LONGEST_TICK, InvalidInput)
        self._time += dt
        if self._drags:
            self._source = "drag"
            self._pulled(dt)
        elif self._is_keyed:
            self._source = "keys"
            self._keyed(dt)
        elif self._clip is not None:
            self._source = "clip"
            self._played(self._clip, dt)
        elif self._tracker is not None and (self._is_fresh or self._source == "tracker"):
            self._tracked()
        else:
            self._source = "still"
        if self._source in ("drag", "keys"):
            self._is_fresh = False
        self._shown = self._finished(dt)
        return self._shown.sample(self._time)

    # --- from actions to postures

    def _number(self, link: str) -> int:
        if link not in self._index:
            raise UnknownName("link", str(link), self._index)
        return self._index[link]

    @property
    def _is_keyed(self) -> bool:
        stepping = self._gait is not None and self._gait.is_stepping
        return self._speeds.is_moving or self._swing is not None or stepping

    def _switch_source(self, source: str) -> None:
        """Switch to another source, starting from the shown posture."""
        if self._source != source or source in ("drag", "clip"):
            self._base = self._shown.copy()
            self._swing = None
            self._speeds.stop()
        if self._source in ("clip", "tracker") or source == "clip" or self._clip is not None:
            self._was_moved = True
            if self._gait is not None:
                self._gait.end()
        self._clip, self._offset = None, None
        self._source = source

    def _offset_to(self, first: Posture) -> Offset:
        return Offset(self._tree, self._shown, first, 0.5 * FASTEST, 0.5 * FASTEST_TURN)

    def _finished(self, dt: float) -> Posture:
        """Return the base posture plus a decaying offset."""
        if self._offset is not None:
            if self._offset.advance(dt):
                return self._offset.added(self._base)
            self._offset = None
        return self._base.copy()

    def _pulled(self, dt: float) -> None:
        """Advance a frame of dragging."""
        step, turn, before = FASTEST * dt, FASTEST_TURN * dt, self._base.roots[0].copy()
        limbs: dict[int, list[int]] = {}
        for k, drag in sorted(self._drags.items()):
            drag.at = drag.at + shortened(drag.goal - drag.at, step)
            if drag.turn is not None:
                drag.turned = turned(drag.turned, shortened(difference(drag.turned, drag.turn), turn))
            root = self._tree.chain(k)[0]
            if k == root and self._tree.nodes[k].is_free:
                self._base.roots[k] = drag.at
                self._base.turns[k] = drag.turned if drag.turn is not None else self._base.turns[k]
            else:
                limbs.setdefault(root, []).append(k)
        if 0 in self._drags and self._gait is not None:
            self._begin_gait()
        for root, links in limbs.items():
            self._pull_limbs(root, tuple(links), step, turn, dt)
        if self._gait is not None and self._gait.is_on and not any(self._gait.is_leg(k) for k in self._drags):
            x, y, _ = ((self._base.roots[0] - before) / dt).tolist()
            self._gait.advance(self._base, (x, y), 0.0, dt, turn)

    def _pull_limbs(self, root: int, links: tuple[int, ...], step: float, turn: float, dt: float) -> None:
        """Pull links of one avatar; its root follows if they stall."""
        goals = [Goal(k, self._drags[k].at, self._drags[k].turned if self._drags[k].turn is not None else None) for k in links]
        pull = self._pull(links)
        is_stuck = pull.solve(self._base, goals, turn, pull.bend(self._base, goals, turn))
        patience = self._stalls.get(links, 0.0) + (dt if is_stuck else -dt)
        self._stalls[links] = min(max(patience, 0.0), PATIENCE)
        if root in self._drags or not self._tree.nodes[root].is_free:
            return
        share = self._stalls[links] / PATIENCE
        moved = shortened(share * pull.error(self._base, goals), step)
        if root == 0 and self._gait is not None and not any(self._gait.is_leg(k) for k in links):
            if not moved.any():
                return
            self._begin_gait()
            low, high = self._gait.heights()
            height = self._gait.height(self._base)
            moved[2] = min(max(height + moved[2], min(low, height)), max(high, height)) - height
        self._base.roots[root] += moved

    def _pull(self, links: tuple[int, ...]) -> Pull:
        if links not in self._pulls:
            self._pulls[links] = Pull(self._tree, links, LEVER * self._span)
        return self._pulls[links]

    def _begin_gait(self) -> None:
        if self._gait is not None and not self._gait.is_on:
            self._gait.begin(self._base, self._was_moved)
            self._was_moved = False

    def _keyed(self, dt: float) -> None:
        """Advance a frame of keys."""
        self._speeds.advance(dt)
        now, gait = self._speeds.now, self._gait
        forward, side, rise, spin = now["forward"], now["side"], now["height"], TURNING * now["turn"]
        for h, opened, closed in self._closing:
            bent = self._base.angles[h] + now["fist"] * (closed - opened) / CLOSING * dt
            self._base.angles[h] = min(max(bent, min(opened, closed)), max(opened, closed))
        for k in self._lifts:
            z, low = self._base.roots[k, 2], self._start.roots[k, 2]
            self._base.roots[k, 2] = min(max(z + now["lift"] * LIFTING * dt, min(low, z)), max(low + HIGHEST, z))
        if self._swing is not None:
            self._swung(self._swing, dt)
        if not self._tree.nodes[0].is_free:
            return
        is_moving = any((forward, side, rise, spin))
        if is_moving:
            self._begin_gait()
        speed = min(FASTEST, self._span if gait is None else gait.speed) / max(1.0, hypot(forward, side))
        facing = yaw_of_x(self._base.turns[0]) if gait is None else gait.forward(self._base)
        x, y, _ = rotate(facing, (forward * speed, side * speed, 0.0)).tolist()
        self._base.turns[0] = turned(self._base.turns[0], (0.0, 0.0, spin * dt))
        raised = rise * min(FASTEST, self._span) * dt
        if gait is not None and is_moving:
            low, high = gait.heights()
            now_at = gait.height(self._base)
            # crouching takes a second
            raised = min(max(now_at + rise * gait.leg * dt, min(low, now_at)), max(high, now_at)) - now_at
        self._base.roots[0] += (x * dt, y * dt, raised)
        if gait is not None and gait.is_on:
            gait.advance(self._base, (x, y), spin, dt, FASTEST_TURN * dt)

    def _reached_out(self) -> Posture:
        """Return the start posture with both arms forward."""
        found = self._start.copy()
        if not self._arms:
            return found
        facing = yaw_of_x(found.turns[0]) if self._gait is None else self._gait.forward(found)
        tips = tuple(arm.tip for arm in self._arms)
        fixed = frozenset(range(len(self._tree.nodes))) - frozenset(k for arm in self._arms for k in arm.links)
        pull = Pull(self._tree, tips, LEVER * self._span, fixed)
        places, _ = self._tree.poses(found)
        goals = []
        for arm in self._arms:
            length = sum(hypot(*self._tree.nodes[k].anchor) for k in arm.links[2:])
            goals.append(Goal(arm.tip, places[arm.links[1]] + rotate(facing, (0.95 * length, 0.0, 0.0))))
        for _ in range(100):
            pull.solve(found, goals, 1.0)
        return found

    def _towards(self, end: Posture) -> _Swing:
        """Return a swing of the arms to a posture, within the joints' speed limit."""
        widest = largest_turn(self._tree, self._base, end, self._arm_joints)
        return _Swing(self._base.copy(), end, self._arm_joints, max(REACHING, STEEPNESS * widest / FASTEST_TURN))

    def _flick(self) -> _Swing:
        """Return a swing of the right arm towards its reach, or of the root ahead, and back."""
        end, links = self._base.copy(), self._tree.moving(self._arms[1].links) if self._arms else []
        if links:
            mixed(self._tree, self._base, self._reached, STRIKE_SHARE, links, end)
            least = largest_turn(self._tree, self._base, end, links) / FASTEST_TURN
        else:
            end.roots[0] += rotate(yaw_of_x(end.turns[0]), (STRIKE_WAY * self._span, 0.0, 0.0))
            least = STRIKE_WAY * self._span / FASTEST
        return _Swing(self._base.copy(), end, links, max(STRIKE, 2.0 * STEEPNESS * least), pulse)

    def _swung(self, swing: _Swing, dt: float) -> None:
        before = swing.course(swing.age / swing.length)
        swing.age += dt
        share = swing.course(swing.age / swing.length)
        mixed(self._tree, swing.start, swing.end, share, swing.links, self._base)
        self._base.roots += (share - before) * (swing.end.roots - swing.start.roots)
        if swing.age >= swing.length:
            self._swing = None

    def _of_clip(self, clip: _Clip) -> Posture:
        """Return the posture of a clip at its time, with the other avatars unchanged."""
        times = clip.motion.times - clip.motion.times[0]
        frame = min(int(np.searchsorted(times, clip.time, side="right")) - 1, len(times) - 1)
        share = 0.0
        if frame + 1 < len(times):
            share = min(max(float((clip.time - times[frame]) / (times[frame + 1] - times[frame])), 0.0), 1.0)
        own = posture_of(clip.motion.between(frame, share))
        found = self._base.copy()
        count = len(own.roots)
        found.roots[:count] = own.roots + clip.shift
        found.turns[:count], found.angles[: len(own.angles)] = own.turns, own.angles
        return self._tree.clip(found)

    def _played(self, clip: _Clip, dt: float) -> None:
        clip.time += dt
        self._base = self._of_clip(clip)
        if clip.time >= clip.motion.times[-1] - clip.motion.times[0] and self._offset is None:
            self._clip = None

    def _tracked(self) -> None:
        if self._tracker is None:
            return
        if self._source != "tracker":
            self._switch_source("tracker")
            self._was_moved = True
            self._offset = self._offset_to(self._tracker)
            if self._gait is not None:
                self._gait.end()
        self._base, self._is_fresh = self._tracker.copy(), False


def _vector(thing: str, value: ArrayLike) -> Array:
    """Check three finite numbers. Raises InvalidSample for anything else."""
    return np.array(vector(thing, np.asarray(value, dtype=object).tolist(), InvalidSample))
