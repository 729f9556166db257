"""Kinematic chains of all avatars, from the trunk to the tips, and their seeded random order (Fisher-Yates shuffle)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import FlagLine, IndexLine, Vectors
from avatarsim.scene.avatar import Avatar
from avatarsim.spatial.random import draw
from avatarsim.world.geometry import Geometry
from avatarsim.world.shapes import ELLIPSOID
from avatarsim.world.skeleton import FREE, Skeleton

Array = NDArray[np.float64]
Index = NDArray[np.int64]

class Chains(NamedTuple):
    """nc chains of links, and what the lower loop needs of each of the nl links.

    first   (nc + 1) chain c has the links link[first[c]] .. link[first[c + 1] - 1], the one next to the trunk first
    link    link indices
    trunk   (nl) True: a free root, or a link shared by several chains above a free root; moved by translation, never by CCD
    root    (nl) the root of the link's avatar
    limb    (nl, 3) from the joint to where the limb ends, in the link's frame [m]; zero if it has no direction
    """

    first: IndexLine
    link: IndexLine
    trunk: FlagLine
    root: IndexLine
    limb: Vectors


def chains_of(avatars: Sequence[Avatar], geo: Geometry, skel: Skeleton) -> Chains:
    """Chains named by the avatars, or from every leaf where none is named; links on no named chain get chains of their own."""
    nl = len(skel.kind)
    root = np.arange(nl, dtype=np.int64)
    for link in range(nl):
        if skel.parent[link] >= 0:
            root[link] = root[skel.parent[link]]
    leaf = ~np.isin(np.arange(nl), skel.parent)
    trunk = skel.kind == FREE
    found: list[list[int]] = []
    start = 0
    for avatar in avatars:
        at = {link.name: start + k for k, link in enumerate(avatar.links)}
        start += len(at)
        leaves = [link for link in at.values() if leaf[link]]
        paths = [_path(skel, tip) for tip in ([at[name] for name in avatar.chains] or leaves)]
        if skel.kind[root[leaves[0]]] == FREE:
            for link in at.values():
                trunk[link] |= sum(link in path for path in paths) > 1
        covered = {link for path in paths for link in path}
        for tip in leaves:
            own = [link for link in _path(skel, tip) if link not in covered]
            covered.update(own)
            paths.append(own)
        found += [[link for link in path if not trunk[link]] for path in paths]
    found = [chain for chain in found if chain]
    flat = np.array([link for chain in found for link in chain], dtype=np.int64)
    return Chains(np.cumsum([0, *(len(chain) for chain in found)]).astype(np.int64), flat, trunk, root, _limbs(found, geo, skel))


def _path(skel: Skeleton, tip: int) -> list[int]:
    """Links from the root to ``tip``."""
    path = [tip]
    while skel.parent[path[-1]] >= 0:
        path.append(int(skel.parent[path[-1]]))
    return path[::-1]


def _limbs(chains: list[list[int]], geo: Geometry, skel: Skeleton) -> Array:
    """To the next joint of the chain; at a tip to the far side of its shapes, twice as far as their middle."""
    limb = np.zeros((len(skel.kind), 3))
    for chain in chains:
        for link, following in zip(chain, [*chain[1:], -1], strict=True):
            if following >= 0 and skel.parent[following] == link and np.any(skel.anchor[following]):
                limb[link] = skel.anchor[following]
            else:
                pieces = range(geo.first_shape[skel.first + link], geo.first_shape[skel.first + link + 1])
                middles = [_middle(geo, piece) for piece in pieces]
                limb[link] = 2.0 * np.mean(middles, axis=0) if middles else 0.0
    return limb


def _middle(geo: Geometry, piece: int) -> Array:
    rows = geo.local[geo.shapes.start[piece] : geo.shapes.start[piece + 1]]
    middle: Array = rows[0] if geo.shapes.kind[piece] == ELLIPSOID else rows.mean(axis=0)
    return middle


@kernel
def shuffle(state_out: Index, order_out: Index) -> None:
    """A fresh random order of 0 .. n - 1 (Fisher and Yates)."""
    n = order_out.shape[0]
    for k in range(n):
        order_out[k] = k
    for k in range(n - 1, 0, -1):
        other = draw(state_out, k + 1)
        kept = order_out[k]
        order_out[k] = order_out[other]
        order_out[other] = kept
