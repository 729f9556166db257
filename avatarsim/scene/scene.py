"""A scene: bodies, avatars, materials, gravity, which pairs may touch. Frozen, and valid once it exists."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import TABLE_1, Body, PairTable, Role
from avatarsim.scene.checks import Vector, bounded, depths, distinct, each, instance, name_pairs, named, require_near
from avatarsim.scene.effects import CALLS, KEPT, Effects, Parts
from avatarsim.scene.tracker import TrackerSample, checked, rest

EARTH: Vector = (0.0, 0.0, -9.81)
"""Gravity [m/s^2] at the scenes' one place on earth; every closed form uses the same figure."""

HEAVIEST = 1e4
"""Largest component of gravity [m/s^2], a thousand times the Earth's. A body that falls for a hundred seconds has come to
`FASTEST`; more: bodies are past it, and past the reasons for that limit, before anything has been seen."""


@dataclass(frozen=True)
class Scene:
    """Everything an engine needs to know before the first frame: `name`, `bodies`, `avatars`, `materials`, `gravity` [m/s^2].

    Canonical order, used by every array in the project: `bodies` first, then the links of each avatar.
    `start` is the avatars' first posture (default: rest posture at the origin); overlapping bodies begin as near as they can.
    `attached` names pairs of a simulated body and the link, or moving body, that holds it from the first frame on.
    `at_rest` names pairs of a link and another link, or a fixed or moving body, that overlap at home, and how deep [m] each may
    be, besides those of an avatar's own `at_rest`.
    `exclude` names pairs that are never tested, `narrow` the effects that the author switches off, `require` those that the
    scene must need, or it is refused. `force` runs effects that no part needs, which costs time and changes nothing:
    its purpose is to show that. Raises InvalidScene for parts that contradict one another, and InvalidSample for a start
    that does not fit the avatars.
    """

    name: str
    bodies: tuple[Body, ...] = ()
    avatars: tuple[Avatar, ...] = ()
    materials: PairTable = TABLE_1
    gravity: Vector = EARTH
    start: TrackerSample | None = field(default=None, compare=False)
    attached: tuple[tuple[str, str], ...] = field(default=(), compare=False)
    exclude: tuple[tuple[str, str], ...] = ()
    narrow: tuple[str, ...] = ()
    require: tuple[str, ...] = ()
    force: tuple[str, ...] = ()
    at_rest: tuple[tuple[str, str, float], ...] = ()

    def __post_init__(self) -> None:
        named("a scene", self.name)
        self._require_types()
        object.__setattr__(self, "gravity", bounded("gravity [m/s^2]", self.gravity, HEAVIEST))
        if not self.bodies and not self.avatars:
            raise InvalidScene(f"number of bodies of scene {self.name}", 0, "at least 1 body or avatar")
        distinct(f"body of scene {self.name}", self.names)
        materials = self.materials.names
        for name, material in zip(self.names, self.material_names, strict=True):
            if material not in materials:
                raise InvalidScene(f"material of {name}", material, "one of " + ", ".join(materials))
        for pair in self.exclude:
            for name in pair:
                if name not in self.names:
                    raise InvalidScene("name in exclude", name, "a body or avatar/link of the scene")
        self._require_attached()
        object.__setattr__(self, "at_rest", self._checked_at_rest())
        self._agree_on_effects()
        if self.start is not None:
            # in arrays, also if it was given in lists
            object.__setattr__(self, "start", checked(self.start, self.avatars))
            require_near("roots of the start", self.start.positions)

    def _require_types(self) -> None:
        """Raise InvalidScene for a part of another type than its place is for."""
        each(f"bodies of scene {self.name}", self.bodies, Body, "a Body; avatars have a place of their own")
        each(f"avatars of scene {self.name}", self.avatars, Avatar, "an Avatar; bodies have a place of their own")
        instance(f"materials of scene {self.name}", self.materials, PairTable, "a PairTable")
        for said in ("exclude", "attached"):
            name_pairs(f"{said} of scene {self.name}", getattr(self, said))
        for said in ("narrow", "require", "force"):
            each(f"{said} of scene {self.name}", getattr(self, said), str, "the name of an effect")

    def _checked_at_rest(self) -> tuple[tuple[str, str, float], ...]:
        """Return the pairs that overlap at home, or raise InvalidScene for one that cannot: loose bodies are moved apart."""
        thing = f"at_rest of scene {self.name}"
        found, role = depths(thing, self.at_rest), dict(zip(self.names, self.roles, strict=True))
        for a, b, _ in found:
            for name in (a, b):
                if role.get(name) not in (Role.FIXED, Role.DRIVEN):
                    raise InvalidScene(f"name in {thing}", name, "a link, or a fixed or moving body, of the scene")
            if Role.DRIVEN not in (role[a], role[b]):
                raise InvalidScene(f"pair in {thing}", (a, b), "at least one link or moving body")
        return found

    def _require_attached(self) -> None:
        """Raise InvalidScene for a pair that is not a simulated body and a link, and for a body that two links hold."""
        role = dict(zip(self.names, self.roles, strict=True))
        for at, wanted, said in ((0, Role.SIMULATED, "a simulated body"), (1, Role.DRIVEN, "an avatar's link or a moving body")):
            for name in (pair[at] for pair in self.attached):
                if role.get(name) is not wanted:
                    raise InvalidScene("name in attached", name, f"{said} of the scene")
        distinct(f"attached body of scene {self.name}", tuple(body for body, _ in self.attached))

    def _agree_on_effects(self) -> None:
        """Raise InvalidScene for an effect that is unknown, or that is required and lacks its part or is narrowed away."""
        Effects().narrowed(*self.narrow, *self.require, *self.force)
        for call in CALLS:
            effect, said = call.effect, f"effect that scene {self.name}"
            if effect in self.require and not self.calls[effect]:
                raise InvalidScene(f"{said} requires", effect, f"one that a part of it calls for; this one takes {call.part}")
            if effect in self.narrow and effect in (*self.require, *self.force):
                raise InvalidScene(f"{said} narrows", effect, "one that it does not require or force as well")
            if effect in self.narrow and effect in KEPT:
                raise InvalidScene(f"{said} narrows", effect, "any other: an avatar without its joints would be another avatar")

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """Return the links of all avatars, in canonical order."""
        return tuple(link for avatar in self.avatars for link in avatar.links)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Return names in canonical order; a link of an avatar of several links is `avatar/link`."""
        return (*(body.name for body in self.bodies), *(name for avatar in self.avatars for name in avatar.link_names))

    @cached_property
    def material_names(self) -> tuple[str, ...]:
        """Return the material of each body and link, in canonical order."""
        return (*(body.material for body in self.bodies), *(link.material for link in self.links))

    @cached_property
    def roles(self) -> tuple[Role, ...]:
        """Return the role of each body and link, in canonical order."""
        return (*(body.role for body in self.bodies), *(Role.DRIVEN for _ in self.links))

    @cached_property
    def first_sample(self) -> TrackerSample:
        """Return the avatars' first posture."""
        return self.start if self.start is not None else rest(self.avatars)

    @cached_property
    def families(self) -> tuple[int, ...]:
        """Return a number for each body and link: those of one number never meet, but for -1, which may meet everything.

        All fixed and moving bodies are one family, and the links of one avatar are when self-contact is switched off.
        """
        found = [0 if body.role is Role.FIXED else -1 for body in self.bodies]
        for k, avatar in enumerate(self.avatars):
            found += [0 if avatar.moves else -1 if self.effects.self_contact else 1 + k] * len(avatar.links)
        return tuple(found)

    @cached_property
    def skipped(self) -> tuple[tuple[int, int], ...]:
        """Return pairs that never meet besides those of one family: link and parent, an avatar's `ignore`, the `exclude`."""
        index = {name: k for k, name in enumerate(self.names)}
        found = [(index[a], index[b]) for a, b in self.exclude]
        first = len(self.bodies)
        for avatar in self.avatars:
            at = {link.name: first + k for k, link in enumerate(avatar.links)}
            found += [(at[link.name], at[link.parent]) for link in avatar.links if link.parent is not None]
            found += [(at[a], at[b]) for a, b in avatar.ignore]
            first += len(at)
        return tuple(found)

    @cached_property
    def pair_filter(self) -> NDArray[np.bool_]:
        """Return (n, n) symmetric: True where two bodies must not overlap; for readers of small scenes, see `model.geometry`.

        Left out: fixed and moving bodies with each other, a link with its parent, the avatar's own `ignore`, the author's
        `exclude`, and links of one avatar with each other when self-contact is switched off.
        """
        family = np.array(self.families)
        wanted: NDArray[np.bool_] = (family[:, None] != family[None, :]) | (family < 0)
        np.fill_diagonal(wanted, False)
        for a, b in self.skipped:
            wanted[a, b] = wanted[b, a] = False
        wanted.flags.writeable = False
        return wanted

    @cached_property
    def resting(self) -> tuple[tuple[int, int, float], ...]:
        """Return pairs of bodies, by number, that overlap at home, and the depth [m] of each: of avatars and of the scene."""
        index = {name: k for k, name in enumerate(self.names)}
        found = {(index[a], index[b]): depth for a, b, depth in self.at_rest}
        first = len(self.bodies)
        for avatar in self.avatars:
            at = {link.name: first + k for k, link in enumerate(avatar.links)}
            found |= {(at[a], at[b]): depth for a, b, depth in avatar.at_rest}
            first += len(at)
        deepest = dict[tuple[int, int], float]()
        for (a, b), depth in found.items():
            pair = min(a, b), max(a, b)
            deepest[pair] = max(depth, deepest.get(pair, 0.0))
        return tuple((a, b, depth) for (a, b), depth in sorted(deepest.items()))

    @cached_property
    def contact_filter(self) -> NDArray[np.bool_]:
        """Return (n, n) symmetric: True where two bodies must not overlap at all: `pair_filter` without the `resting` pairs."""
        wanted = self.pair_filter.copy()
        for a, b, _ in self.resting:
            wanted[a, b] = wanted[b, a] = False
        wanted.flags.writeable = False
        return wanted

    @cached_property
    def calls(self) -> Mapping[str, tuple[str, ...]]:
        """Return for each effect the parts of the scene that need it, by name."""
        parts = Parts(self.bodies, self.avatars, self.materials)
        return {call.effect: tuple(call.found(parts)) for call in CALLS}

    @cached_property
    def derived_effects(self) -> Effects:
        """Return the effects that the parts of the scene need."""
        return Effects(**{effect: bool(parts) for effect, parts in self.calls.items()})

    @cached_property
    def effects(self) -> Effects:
        """Return the derived effects, less those that the author narrowed away, and those that are forced."""
        return self.derived_effects.narrowed(*self.narrow).widened(*self.force)

    @cached_property
    def whole(self) -> "Scene":
        """Return the scene with the effects that its parts need: it is judged as that, whatever its author left out."""
        return replace(self, narrow=(), require=(), force=()) if self.narrow or self.force else self

    @cached_property
    def lapsed(self) -> Mapping[str, str]:
        """Return effects that the author took away although a part needs them, and the promise that lapses with each."""
        gone = self.effects.missing_from(self.derived_effects)
        return {call.effect: call.lapses for call in CALLS if call.effect in gone}
