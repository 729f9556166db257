"""Support matrix: what a project that would use the engine asks first, each answered yes, no or not measured, with the facts."""

from dataclasses import dataclass

YES, NO, PARTLY, UNMEASURED = "yes", "no", "partly", "not measured"


@dataclass(frozen=True)
class Answer:
    """One question and its answer: word is one of those above, facts a sentence or two."""

    question: str
    word: str
    facts: str


ANSWERS = (
    Answer("Triangle meshes as they are", NO, "Shapes are convex pieces; python -m avatarsim.pieces MESH makes them and bounds "
           "how far pieces and mesh are apart."),
    Answer("Scenery that is animated, such as lifts and doors", NO, "Bodies are fixed, simulated or links of an avatar. A link "
           "that is moved by a tracker stops at what it meets instead of pushing through it."),
    Answer("Several avatars", YES, "Each with its own tracker; make bench goes up to 100."),
    Answer("Avatars of your own: hand-tracking skeletons, other bodies", YES, "Trees of links with hinges, ball joints and reach "
           "cones, described in Python; there is no importer for formats of avatars or motion."),
    Answer("Grabbing", PARTLY, "Things are pushed and held by contact alone; nothing attaches a thing to a hand."),
    Answer("Bodies that come and go", NO, "A scene is loaded whole; another one is another load."),
    Answer("C, Unity, Unreal, OpenXR", NO, "The engine is called from Python; there is no other binding."),
    Answer("Several threads", NO, "A frame is computed on the thread that asks for it."),
    Answer("Large worlds", YES, "make bench goes up to 20,000 objects, most of them at rest, and 1,000 contacts."),
    Answer("Contact force, joint torque, haptics", UNMEASURED, "The avatar is kinematic: no figure on this page is a force."),
    Answer("Licence", YES, "Apache-2.0."),
)
"""In the order in which they are asked."""
