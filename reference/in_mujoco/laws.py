"""Contact laws between bodies, written to MuJoCo with as few explicit pairs as possible.

MuJoCo mixes the parameters of two geoms by taking those of the one with the higher priority. That cannot
express a symmetric table of pairs, but it can express most of one. The rest is listed as explicit pairs,
which cost time each.
"""

from collections import Counter
from dataclasses import dataclass
from itertools import combinations

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene

BOUNCY = 0.3
"""Restitution above which a pair must be explicit: only there can friction have its own, non-bouncy time
constant. With geoms alone a box sliding at restitution 0.8 stops 5 % short and creeps at rest; at 0.3 (all of
Table 1) it does not."""

MAX_RUBBING = 500
"""Pairs of bodies that do not bounce up to which each is explicit, so that its friction can be softer than its normal: see
`friction_steps_resting` in presets.py. Above it, only their geoms carry the law."""

MAX_CLASSES = 10
"""Classes of bodies up to which the best order of priorities is searched (2^10 sets); beyond it all pairs are
explicit."""


@dataclass(frozen=True)
class Law:
    """Contact law of two bodies. `stops` means no bounce: one of them is driven, none is simulated."""

    friction: float
    restitution: float
    stops: bool

    @property
    def rubs(self) -> bool:
        """Return True if simulated bodies slide on each other without ever bouncing."""
        return self.friction > 0.0 and self.restitution == 0.0 and not self.stops


@dataclass(frozen=True)
class Laws:
    """`own`: body -> (priority, law) for its geoms; `explicit`: pairs (a, b), a < b, whose law geoms cannot
    express."""

    own: tuple[tuple[int, Law], ...]
    explicit: dict[tuple[int, int], Law]


def law_between(scene: Scene, a: int, b: int) -> Law:
    """Return Table 1 for bodies a and b without the effects that the author narrowed away; driven bodies stop at bodies that are
    not simulated."""
    contact = scene.materials.contact(scene.material_names[a], scene.material_names[b])
    stops = Role.SIMULATED not in (scene.roles[a], scene.roles[b])
    restitution = 0.0 if stops or not scene.effects.restitution else contact.restitution
    # friction of a scene without simulated bodies still acts on a hand on a table
    narrowed = scene.derived_effects.friction and not scene.effects.friction
    return Law(0.0 if narrowed else contact.friction, restitution, stops)


def contact_laws(scene: Scene, bounce: bool) -> Laws:
    """Return priorities and laws of all bodies, and the pairs that must be explicit. Without `bounce` only friction
    counts."""
    n, wanted = len(scene.names), scene.contact_filter
    classes = [(material, role) for material, role in zip(scene.material_names, scene.roles, strict=True)]
    known = sorted(set(classes), key=lambda c: (c[0], c[1].value))
    at = [known.index(c) for c in classes]
    counts: Counter[tuple[int, int]] = Counter()
    law: dict[tuple[int, int], Law] = {}
    for a in range(n):
        for b in range(a + 1, n):
            if wanted[a, b]:
                key = (min(at[a], at[b]), max(at[a], at[b]))
                counts[key] += len(_pieces(scene, a)) * len(_pieces(scene, b))
                if key not in law:
                    stated = law_between(scene, a, b)
                    law[key] = stated if bounce else Law(stated.friction, 0.0, False)
    order, own = _cheapest_order(len(known), counts, law)
    rank = {c: k for k, c in enumerate(order)}
    explicit = {}
    few = sum(count for key, count in counts.items() if law[key].rubs) <= MAX_RUBBING
    for a in range(n):
        for b in range(a + 1, n):
            if wanted[a, b]:
                key = (min(at[a], at[b]), max(at[a], at[b]))
                winner = max(key, key=lambda c: rank[c])
                apart = law[key].restitution > BOUNCY or (few and bounce and law[key].rubs)
                if law[key] != own[winner] or apart or len(known) > MAX_CLASSES:
                    explicit[a, b] = law[key]
    return Laws(tuple((rank[c], own[c]) for c in at), explicit)


def _cheapest_order(n: int, counts: Counter[tuple[int, int]],
                    law: dict[tuple[int, int], Law]) -> tuple[list[int], list[Law]]:
    """Return the order of classes, lowest priority first, that leaves the fewest pairs of geoms to be explicit.

    The cost of a class depends only on the set of classes below it: dynamic programming over sets.
    """
    def best(top: int, below: frozenset[int]) -> tuple[int, Law]:
        votes: Counter[Law] = Counter()
        for other in {*below, top}:
            key = (min(top, other), max(top, other))
            if key in law:
                votes[law[key]] += counts[key]
        if not votes:
            return 0, Law(1.0, 0.0, False)
        favourite = max(votes, key=lambda v: (votes[v], v.friction, v.restitution))
        return sum(votes.values()) - votes[favourite], favourite

    if n > MAX_CLASSES:
        return list(range(n)), [Law(1.0, 0.0, False)] * n
    table: dict[frozenset[int], tuple[int, tuple[int, ...], tuple[Law, ...]]] = {frozenset(): (0, (), ())}
    for size in range(1, n + 1):
        for members in combinations(range(n), size):
            options = []
            for top in members:
                cost, order, laws = table[frozenset(members) - {top}]
                extra, favourite = best(top, frozenset(members) - {top})
                options.append((cost + extra, (*order, top), (*laws, favourite)))
            table[frozenset(members)] = min(options, key=lambda option: option[:2])
    _, order, laws = table[frozenset(range(n))]
    own = [Law(1.0, 0.0, False)] * n
    for c, chosen in zip(order, laws, strict=True):
        own[c] = chosen
    return list(order), own


def _pieces(scene: Scene, body: int) -> tuple[object, ...]:
    first = len(scene.bodies)
    return scene.bodies[body].pieces if body < first else scene.links[body - first].pieces
