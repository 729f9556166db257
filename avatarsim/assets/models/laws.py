"""Contact laws of a model file: friction of its geoms, combined as MuJoCo does; restitution of the table of materials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations_with_replacement
from operator import itemgetter

from avatarsim.assets import caps
from avatarsim.assets.models.compiled import Compiled
from avatarsim.errors import InvalidFile
from avatarsim.scene.body import TABLE_1, ContactLaw, PairTable


@dataclass(frozen=True)
class Stated:
    """Material of a file. `base` names the material of the table whose restitution it has.

    Of two materials the one of higher `priority` gives the friction; `is_smooth` is contact without friction (`condim` 1)."""

    base: str
    friction: float
    priority: int = 0
    is_smooth: bool = False


@dataclass(frozen=True)
class Frictions:
    """Materials of a file by name, and the friction of pairs of them that the file states explicitly."""

    materials: Mapping[str, Stated] = field(default_factory=dict)
    pairs: Mapping[tuple[str, str], float] = field(default_factory=dict)

    def __or__(self, other: "Frictions") -> "Frictions":
        return Frictions({**self.materials, **other.materials}, {**self.pairs, **other.pairs})

    def table(self) -> PairTable:
        """Return the table of all pairs: of two materials the larger friction, or that of the higher priority.

        A material of the table, in a pair with one of the file, counts with its own friction against the file's base.
        """
        if not self.materials:
            return TABLE_1
        names = (*TABLE_1.names, *self.materials)
        laws = {(a, b): self._law(a, b) for a, b in combinations_with_replacement(names, 2)}
        return PairTable({pair: law for pair, law in laws.items() if law is not None})

    def _law(self, a: str, b: str) -> ContactLaw | None:
        one, other = self.materials.get(a), self.materials.get(b)
        bases = (one.base if one else a, other.base if other else b)
        if bases not in TABLE_1.pairs:
            return None
        known = TABLE_1.contact(*bases)
        if (a, b) in self.pairs or (b, a) in self.pairs:
            friction = self.pairs.get((a, b), self.pairs.get((b, a), 0.0))
        elif one and other:
            friction = combined(one, other)
        else:
            friction = max([known.friction, *(part.friction for part in (one, other) if part)])
        return ContactLaw(known.restitution, friction)


def combined(one: Stated, other: Stated) -> float:
    """Return the friction of two materials by MuJoCo's rule."""
    highest = max(one.priority, other.priority)
    deciding = [part for part in (one, other) if part.priority == highest]
    return 0.0 if all(part.is_smooth for part in deciding) else max(part.friction for part in deciding)


class Laws:
    """Materials of the parts of a compiled model. URDF states no friction: its parts have the materials of the table."""

    def __init__(self, model: Compiled, file: str) -> None:
        self._m, self._file = model, file
        self._stated: dict[str, Stated] = {}
        two = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
        self._pairs = [(*pair, float(friction)) for pair, friction in zip(two, model.pair_friction, strict=True)]
        of_rule = {(g, h): combined(self._geom(g), self._geom(h)) for g, h, _ in self._pairs}
        self._paired = {geom for g, h, friction in self._pairs if friction != of_rule[g, h] for geom in (g, h)}
        self._of_geom: dict[int, str] = {}
        self._mixed: list[str] = []

    def _geom(self, geom: int, base: str = "") -> Stated:
        m = self._m
        return Stated(base, float(m.geom_friction[geom]), int(m.geom_priority[geom]), bool(m.geom_condim[geom] == 1))

    def _touch(self, g: int, h: int) -> bool:
        types, affinities = self._m.geom_contype, self._m.geom_conaffinity
        return bool(types[g] & affinities[h] or types[h] & affinities[g])

    def material(self, name: str, geoms: Sequence[int], base: str) -> str:
        """Return the material of the part of this name: of its geoms' frictions the largest of the highest priority."""
        if self._m.is_urdf or not geoms:
            return base
        every = {self._geom(g, base) for g in geoms}
        priority = max(one.priority for one in every)
        found = {one for one in every if one.priority == priority}
        if len(found) > 1:
            self._mixed.append(name)
        stated = Stated(base, max(one.friction for one in found), priority, all(one.is_smooth for one in found))
        material = f"{base} {stated.friction}" + (f" over {priority}" if priority else "") + " smooth" * stated.is_smooth
        if self._paired & set(geoms):
            # a separate one, since the file states another friction of a pair with it
            material = f"{material} of {name}"
            self._of_geom |= {g: material for g in geoms}
        self._stated[material] = stated
        if len(self._stated) > caps.MATERIALS:
            raise InvalidFile(f"frictions of geoms of {self._file}", len(self._stated), f"up to {caps.MATERIALS} different ones")
        return material

    def frictions(self) -> Frictions:
        """Return all materials so far."""
        stated = {frozenset((g, h)): friction for g, h, friction in sorted(self._pairs, key=itemgetter(2))}
        geoms: dict[str, list[int]] = {}
        for geom, material in self._of_geom.items():
            geoms.setdefault(material, []).append(geom)
        pairs: dict[tuple[str, str], float] = {}
        for one, other in {(self._of_geom.get(g), self._of_geom.get(h)) for g, h, _ in self._pairs}:
            if one is not None and other is not None:
                # of other geoms of the two, which may touch too, by the rule
                found = [
                    stated.get(frozenset((g, h)), combined(self._geom(g), self._geom(h)))
                    for g in geoms[one] for h in geoms[other] if frozenset((g, h)) in stated or self._touch(g, h)
                ]
                pairs[one, other] = max(found)
        return Frictions(self._stated, pairs)

    def notes(self) -> tuple[str, ...]:
        """Return a sentence on parts whose geoms differ in friction."""
        if not self._mixed:
            return ()
        return (f"of {', '.join(self._mixed)} the largest friction of several geoms counts",)
