"""Glossary: the words of this page that are its own, each in a sentence."""

TERMS = (
    ("user, target", "The posture that the tracker reports, links and all: where the person really is. In a file: tracker."),
    ("shown", "What an engine puts on the screen at the end of a frame: its answer to the target."),
    ("raw tracker", "The target shown as it is, without contact: how large the problem is. It is ranked nowhere."),
    ("deepest overlap shown", "How far two bodies are in one another at most, over all states shown, by the judge."),
    ("frames in contact that shake", "Share of the frames in contact in which a link goes to and fro, faster than 0.18 m/s, in 3 "
     "of the last 4 frames, while its target does not turn back."),
    ("displacement taken back", "What a link moved in one frame and took back in the next while its target did not turn back."),
    ("roughness of motion", "95th percentile of the third differences of link places, shown over target; 1 is as smooth as the "
     "user."),
    ("frames far from a free user without a status", "The target has been free for half a second, a link is more than 10 cm off, "
     "and the engine says nothing of it."),
    ("left the allowed side", "Something was where the scene says that it cannot be, such as behind a wall."),
    ("bound, ceiling", "A bound is a figure that our engine promises in a scene; a ceiling stands in for one that does not hold "
     "yet. The gate, which can fail, is all bounds of one engine and preset."),
    ("family", "A scene with its variants: other frame rates, other clips, other sizes. Sentences count families."),
    ("default", "An engine with its documented defaults; of ours, the method that is meant to be used."),
    ("tuned", "MuJoCo or PyBullet with the best settings that are known here for the scene, see Settings."),
    ("paper", "Our engine with the method as it was printed in 2004, for comparison with it."),
    ("cannot say", "A part of a scene that an engine has no words for; figures of just that do not rank it."),
    ("engine only, as called", "Time inside the engine, and time of the whole call from Python; see Provenance and fairness."),
    ("p50, p95, p99", "The time that 50, 95 or 99 % of the frames of a scene stay below."),
    ("equation 6, coupling", "The spring and damper of the paper between a driven hand and a coupled mass, through which "
     "simulated bodies act back on it."),
)
"""(words, meaning), in the order in which the page uses them."""
