"""Glossary: the words of this page that are its own, each in a sentence."""

from reports.sections.sweep import beaten
from reports.sections.sweep.points import Sweep

TUNED = "tuned"
TERMS = (
    ("user, target", "The posture that the tracker reports, links and all: where the person really is. In a file: tracker."),
    ("shown", "What an engine puts on the screen at the end of a frame: its answer to the target."),
    ("raw tracker", "The target shown as it is, without contact: how large the problem is. It is ranked nowhere."),
    ("deepest overlap shown", "How far two bodies are in one another at most, over all states shown, by the judge."),
    ("frames in contact that shake", "Share of the frames in contact in which a link goes to and fro, faster than 0.18 m/s, in 3 "
     "of the last 4 frames, while its target does not turn back."),
    ("displacement taken back", "What a link moved in one frame and took back in the next while its target did not turn back: "
     "the smaller of the two. The largest to and fro is the largest of it."),
    ("jitter in contact", "The root mean square of the displacement taken back, over frames in contact in which a link's target "
     "rests or slides slower than 0.18 m/s; 0 in frames without any; of the link that has most. A larger one is not left out: it "
     "counts as what that speed covers in a frame, 3 mm at 60 Hz. Where few frames are in contact one such event decides the "
     "figure: in n frames it alone is 3 mm over the root of n."),
    ("jump", "What a link or the root moves in one frame more than its user does. An avatar of ours that "
     "was held back catches up by catch_up_move times the frame (83 mm at 60 Hz as set); a frame can show more."),
    ("turn", "What a joint turns in one frame more than its user does, in the frame of its parent; a root, or a body without "
     "joints such as the rigid hand of thin_wall_hand, turns in the world. Of an avatar the largest turn of any joint, less the "
     "largest of its user's."),
    ("change of orientation", "What a whole link turns in one frame in the world, and so with the turns of all joints from the "
     "root to it, more than its user's link does: named at the worst moments of a scene. A turn of the root alone changes the "
     "orientation of every link."),
    ("angle beyond joint limits, angle beyond a reach cone", "Two figures: how far a hinge is beyond its range, or a ball joint "
     "beyond its swing or twist; and how far a limb points outside the reach cone of its ball joint."),
    ("waiting", "An avatar is held off its user by more than 5 cm and has come no nearer for stall_time, and no path around "
     "what holds it is being sought or known. Status: waiting; planning while a path is sought, following along it. How long "
     "an avatar waits counts the first two together."),
    ("leap", "A target that is elsewhere from one frame to the next, such as after a teleport. Its way is followed in that "
     "frame as far as it is free; what is in between is then planned around."),
    ("roughness of motion", "95th percentile of the third differences of link places, shown over target; 1 is as smooth as the "
     "user."),
    ("frames far from a free user without a status", "The target has been free for half a second, a link is more than 10 cm off, "
     "and the engine says nothing of it."),
    ("lift, energy of a lift", "A body that is inside another is moved out of it by its place alone. Upwards that is a height, "
     "which is ranked, and weight times that height a potential energy in joule. No velocity comes of it, so that the energy "
     "audit, which counts kinetic energy that nothing explains, does not count it."),
    ("left the allowed side", "Something was where the scene says that it cannot be, such as behind a wall."),
    ("bound, check, waived", "A bound is a figure that our engine promises in a scene, and a check whether it holds. A check is "
     "waived where the bound does not hold yet, up to a stated figure. The gate is all checks of one engine and preset."),
    ("family", "A scene with its variants: other frame rates, other clips, other sizes. Sentences count families."),
    ("default", "An engine with its default parameters in our rig (MuJoCo: a weld per link; PyBullet: a constraint of the root "
     "and a motor per joint); of ours, the method that is meant to be used."),
    (TUNED, "MuJoCo or PyBullet as tuned here for accuracy in scenes of a kind, see Settings."),
    ("paper", "Our engine with the method as it was printed in 2004, for comparison with it."),
    ("cannot say", "A part of a scene that an engine has no words for; figures of just that do not rank it."),
    ("engine only, as called", "Time inside the engine, and time of the whole call from Python; see Provenance and fairness."),
    ("p50, p95, p99", "The time that 50, 95 or 99 % of the frames of a scene stay below."),
    ("equation 6, coupling", "The spring and damper of the paper between a driven hand and a coupled mass, through which "
     "simulated bodies act back on it."),
)
"""(words, meaning), in the order in which the page uses them."""


def terms(sweep: Sweep | None) -> tuple[tuple[str, str], ...]:
    """The same, and of tuned settings where others of the run's own sweep beat them."""
    found = beaten.beaten(sweep) if sweep else ()
    if not found:
        return TERMS
    said = f"{beaten.sentence(found).removesuffix('.')}: the list stands under Accuracy against time."
    return tuple((word, f"{meaning} {said}" if word == TUNED else meaning) for word, meaning in TERMS)
