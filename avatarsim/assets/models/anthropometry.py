"""Anthropometry of a recorded human: body parts by joint names, segment masses (de Leva 1996), radii that follow from them.

Names of CMU (ASF and BVH), LAFAN1, Mixamo, Daz, SOMA, 3ds Max and the hip-knee-ankle convention, in one table of synonyms.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from avatarsim.assets.models.skeleton import Skeleton

STATURE, BODY_MASS = 1.741, 75.0
"""Stature [m] and mass [kg] of the table's body: de Leva's male subjects, rounded."""


@dataclass(frozen=True)
class Segment:
    """A segment of the body: `share` of the body's mass, `density` [kg/m^3] (Winter 2005), `length` [m] at STATURE, and how much
    `wider` than deep it is."""

    share: float
    density: float
    length: float
    wider: float = 1.0

    def radius(self, mass: float, stature: float) -> float:
        """Return the radius [m] of the cylinder of the segment's volume and length in a body of `mass` [kg] and STATURE.
        Of a segment that is wider than deep it is half its depth. Bodies of another `stature` [m] are similar to it."""
        area = self.share * mass / (self.density * self.length)
        return math.sqrt(area / (math.pi * self.wider)) * stature / STATURE


SEGMENTS = {
    "head": Segment(0.0694, 1110.0, 0.243),
    "trunk": Segment(0.4346, 1030.0, 0.515, 1.6),
    "upper arm": Segment(0.0271, 1070.0, 0.2817),
    "forearm": Segment(0.0162, 1130.0, 0.2689),
    "hand": Segment(0.0061, 1160.0, 0.19, 2.0),
    "thigh": Segment(0.1416, 1050.0, 0.4222),
    "shank": Segment(0.0433, 1090.0, 0.4340),
    "foot": Segment(0.0137, 1100.0, 0.2581),
}
"""Shares of male bodies (de Leva 1996); those of the limbs are of one side. Together they are the whole body."""

MIDDLE = ("head", "trunk")
"""Segments that a body has once."""

SEGMENT_OF = {
    "pelvis": "trunk", "spine": "trunk", "clavicle": "trunk", "hip bone": "trunk", "neck": "head", "head": "head", "face": "head",
    "upper arm": "upper arm", "forearm": "forearm", "hand": "hand", "thumb": "hand", "finger": "hand",
    "thigh": "thigh", "shank": "shank", "foot": "foot", "toe": "foot",
}
"""The segment that a part of the body belongs to."""

SEGMENT_OF_KIND = {kind: SEGMENTS[name] for kind, name in SEGMENT_OF.items()}
"""Segment figures by kind of part."""

RADII = {"neck": 0.055, "clavicle": 0.045, "hip bone": 0.07, "thumb": 0.010, "finger": 0.008, "toe": 0.025}
"""Radii [m] at STATURE of parts that are thinner than their segment: half of their caliper width, rounded."""

KNEE, ABOVE_KNEE = 0.052, 0.6
"""Radius [m] at STATURE of a thigh at its lower end, half of a knee's breadth, and the share of its length, from the hip, over
which it has that of the segment: with one radius all along, knees that pass each other in a walk would overlap by centimetres."""

SHOULDERS = 0.61
"""Radius of the trunk at most, as a share of half the distance of the shoulder joints: its value in the table's body, whose
joints are 0.36 m apart. More: arms of skeletons with narrow shoulders hang inside the trunk."""

UNKNOWN_SHARE = 0.15
"""Radius of a bone of unknown name, as a share of its length: about that of the forearm, whose table has 0.13."""

THINNEST, THICKEST = 0.005, 0.15
"""Least and largest radii [m] of bones of unknown name: a finger's and a trunk's."""

SYNONYMS = {
    "pelvis": "hips hip pelvis root lowerbody hipscontrol",
    "spine": "spine lowerback upperback chest upperchest thorax torso abdomen abdomenlower abdomenupper chestlower chestupper "
             "waist lowerspine midspine upperspine lumbar sternum",
    "neck": "neck lowerneck upperneck necklower neckupper",
    "head": "head skull headtop",
    "face": "eye eyes jaw tongue eyelid brow",
    "clavicle": "clavicle collar scapula",
    "shoulder": "shoulder",
    "hip bone": "hipjoint buttock",
    "upper arm": "arm upperarm uparm shldr humerus shldrbend shldrtwist",
    "forearm": "forearm lowerarm lowarm radius elbow forearmroll forearmbend forearmtwist ulna",
    "hand": "hand wrist palm",
    "thumb": "thumb handthumb",
    "finger": "fingers finger index mid middle ring pinky little handindex handmiddle handmid handring handpinky handlittle "
              "fingerbase handfinger fingersbase carpal handpalm handpinkie pinkie inhandindex "
              "inhandmiddle inhandring inhandpinky",
    "thigh": "thigh upleg upperleg femur thighbend thightwist",
    "leg": "leg",
    "shank": "shank shin knee tibia lowerleg lowleg calf",
    "foot": "foot ankle heel metatarsals",
    "toe": "toe toes toebase ball bigtoe smalltoe forefoot",
}
"""Words in names of joints, without side, numbers and separators. `shoulder` and `leg` depend on neighbours."""

PREFIXES = re.compile(r"(?i)^((mixamorig\d*|bip0*\d*|character\d+|skel|jnt|cc_base|j|b)[ _-]+)*(mixamorig\d*|bip0*1)?")
"""Prefixes that tools add to names."""

SUFFIXES = re.compile(r"([ _-](?i:end|nub|tip|site)|End|Nub|Tip)$")
"""Suffixes that tools add to the name of a joint that only marks the end of the one before."""

WORDS = {word: part for part, words in SYNONYMS.items() for word in words.split()}
SIDED = frozenset({
    "clavicle", "shoulder", "hip bone", "upper arm", "forearm", "hand", "thumb", "finger", "thigh", "leg", "shank", "foot", "toe",
})
"""Parts of which a body has two."""


@dataclass(frozen=True)
class Part:
    """Part of the body by a joint's name: its `kind`, "" where unknown, and its `side`: "left", "right" or ""."""

    kind: str
    side: str


def parts(skeleton: Skeleton) -> tuple[Part, ...]:
    """Return the body part of each bone, by its name and, where that is ambiguous, by its neighbours' names."""
    read = [_read(bone.name) for bone in skeleton.bones]
    found: list[Part] = []
    for k, bone in enumerate(skeleton.bones):
        kind, side = read[k]
        below = {read[child] for child in _subtree(skeleton, k)}
        above = found[bone.parent] if bone.parent >= 0 else Part("", "")
        if kind == "shoulder":
            kind = "clavicle" if ("upper arm", side) in below else "upper arm"
        elif kind == "leg":
            kind = "shank" if above == Part("thigh", side) else "thigh"
        elif kind == "pelvis" and side:
            kind = "thigh"
        found.append(Part(kind, side))
    return tuple(found)


def _subtree(skeleton: Skeleton, k: int) -> Sequence[int]:
    """Return the bones below bone k, two levels deep."""
    first = skeleton.children[k]
    return [*first, *(below for child in first for below in skeleton.children[child])]


def _read(name: str) -> tuple[str, str]:
    """Return (kind, side) of a name by itself; ("", "") where it is unknown."""
    bare = re.split(r"[:|]", name)[-1]
    bare = SUFFIXES.sub("", PREFIXES.sub("", bare.strip()))
    for side, word in _sides(bare):
        kind = WORDS.get(word, "")
        if kind and (not side or kind in SIDED or kind in ("face", "pelvis")):
            return kind, side
    return "", ""


def _sides(bare: str) -> list[tuple[str, str]]:
    """Return the possible (side, word) of a name, the likeliest first: `LeftArm`, `lShldr`, `L_Thigh`, `thumb.R`, `Hips`."""
    words = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", bare)
    letters = "".join(words).lower()
    found: list[tuple[str, str]] = []
    for side in ("left", "right"):
        if letters.startswith(side):
            found.append((side, letters[len(side) :]))
        elif letters.endswith(side):
            found.append((side, letters[: -len(side)]))
        elif words and words[0].lower() == side[0]:
            found.append((side, letters[1:]))
        elif words and words[-1].lower() == side[0]:
            found.append((side, letters[:-1]))
    found.append(("", letters))
    # lower-case names such as CMU's lfemur: only if the rest is a word by itself
    found += [(side, letters[1:]) for side in ("left", "right") if letters.startswith(side[0]) and len(letters) > 3]
    return found
