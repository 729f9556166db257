"""Materials: restitution and friction belong to a *pair* of materials, as in the paper's Table 1."""

from collections.abc import Mapping
from dataclasses import dataclass

from avatarsim.errors import InvalidScene, UnknownName
from avatarsim.scene.checks import instance, name_pairs, within


@dataclass(frozen=True)
class ContactLaw:
    """Contact law of a pair of materials: `restitution` (eq. 8, 0 to 1) and Coulomb `friction` (eq. 10, 0 to 100), which have no
    unit. Raises InvalidScene for others."""

    restitution: float
    friction: float

    def __post_init__(self) -> None:
        within("restitution", self.restitution, 0.0, 1.0)
        within("friction", self.friction, 0.0, 100.0)


@dataclass(frozen=True)
class PairTable:
    """The contact law of every unordered pair of material names: `PairTable({("ice", "metal"): ContactLaw(0.1, 0.02)})`.

    Raises InvalidScene for a pair that is stated twice and differently; a scene in which two materials may meet that have no
    pair is refused with UnknownName when it is loaded."""

    pairs: Mapping[tuple[str, str], ContactLaw]

    def __post_init__(self) -> None:
        instance("pairs of a PairTable", self.pairs, Mapping, "a mapping {(name, name): ContactLaw(restitution, friction)}")
        name_pairs("pairs of a PairTable", tuple(self.pairs))
        both_ways = dict[tuple[str, str], ContactLaw]()
        for (a, b), contact in self.pairs.items():
            instance(f"contact of {a} and {b}", contact, ContactLaw, "a ContactLaw(restitution, friction)")
            if both_ways.get((a, b), contact) != contact:
                raise InvalidScene(f"contact of {a} and {b}", contact, f"that of {b} and {a}, {both_ways[a, b]!r}")
            both_ways[a, b] = both_ways[b, a] = contact
        object.__setattr__(self, "pairs", both_ways)

    @property
    def names(self) -> tuple[str, ...]:
        """Every material that occurs, sorted."""
        return tuple(sorted({name for pair in self.pairs for name in pair}))

    def contact(self, a: str, b: str) -> ContactLaw:
        """Coefficients of materials a and b, in either order."""
        try:
            return self.pairs[a, b]
        except KeyError:
            raise UnknownName("pair of materials", f"{a}, {b}", (f"{x}, {y}" for x, y in self.pairs)) from None


TABLE_1 = PairTable(
    {
        ("wood", "wood"): ContactLaw(0.3, 0.3),
        ("wood", "human"): ContactLaw(0.2, 0.2),
        ("wood", "metal"): ContactLaw(0.2, 0.1),
        ("human", "human"): ContactLaw(0.1, 0.1),
        ("human", "metal"): ContactLaw(0.2, 0.1),
        ("metal", "metal"): ContactLaw(0.3, 0.1),
    }
)
"""The paper's Table 1: restitution and friction of wood, human and metal."""
