"""What the page answers to a project that would use the engine is true of this source, and its figures are those of the run."""

import tomllib
from collections.abc import Callable
from pathlib import Path

from avatarsim.errors import StartOverlaps
from avatarsim.scene.body import Role
from avatarsim.settings import PostureSettings, meanings
from avatarsim.simulator import AvatarsimEngine
from reports.reading.load import Results, load
from reports.sections.growth import Growth, Point
from reports.sections.your_project import ABSENT, NO, PARTLY, PER_FRAME, UNMEASURED, YES, answers, not_for
from tests.reports.conftest import row, whole_run

ROOT = Path(__file__).resolve().parents[3]
OURS = "avatarsim/default"
Json = dict[str, object]
Write = Callable[[object], Path]


def made(write: Write, *rows: Json) -> Results:
    plain = whole_run()
    assert isinstance(plain["rows"], list)
    return load(write(plain | {"rows": [*plain["rows"], *rows], "scenes": {"maze": {"title": "", "dt": 1 / 90}}}))


def fact(results: Results, question: str, growth: Growth | None = None) -> str:
    (found,) = [one for one in answers(results, OURS, growth) if one.question.startswith(question)]
    return found.facts


def word(results: Results, question: str, growth: Growth | None = None) -> str:
    (found,) = [one for one in answers(results, OURS, growth) if one.question.startswith(question)]
    return found.word


def test_every_answer_is_one_of_the_words_and_has_its_facts(run_dir: Write) -> None:
    found = answers(made(run_dir), OURS)
    assert all(one.word in (YES, NO, PARTLY, UNMEASURED) and one.facts.endswith(".") for one in found)
    assert len({one.question for one in found}) == len(found)


def test_licence_and_kinds_of_bodies_are_those_of_the_source(run_dir: Write) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["license"] in fact(made(run_dir), "Licence")
    assert {role.name for role in Role} == {"FIXED", "SIMULATED", "DRIVEN"}, "another kind would make the second answer false"


def test_what_it_is_not_for_has_an_answer_that_says_no(run_dir: Write) -> None:
    no = {one.question for one in answers(made(run_dir), OURS) if one.word == NO}
    for said, question in (("OpenXR", "C, Unity"), ("scenery that moves", "Scenery"),
                           ("meshes as they are", "Triangle meshes"), ("a grip that attaches", "Grabbing"),
                           ("begin inside", "A start inside")):
        assert said in not_for() and any(one.startswith(question) for one in no)
    assert "change(scene)" in fact(made(run_dir), "Bodies that come") and hasattr(AvatarsimEngine, "change")


def test_formats_of_avatars_and_motion_are_those_that_are_read(run_dir: Write) -> None:
    said = fact(made(run_dir), "Avatars of your own")
    readers = {path.stem for path in (ROOT / "avatarsim" / "assets").rglob("*.py")}
    assert {"bvh", "asf_amc", "npz", "table", "from_mujoco", "smpl_skeleton"} <= readers
    assert all(name in said for name in ("URDF", "MJCF", "SMPL", "BVH", "AMC", "NPZ", "CSV"))
    assert all((ROOT / page).is_file() for page in ("docs/files.md", "docs/live.md")) and "docs/files.md" in said


def test_no_kernel_runs_on_several_threads(run_dir: Write) -> None:
    sources = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "avatarsim").rglob("*.py")}
    assert not any(word in text for word in ("parallel=True", "prange") for text in sources.values())
    assert [name for name, text in sources.items() if "ThreadPool" in text] == ["many_worlds"]
    said = fact(made(run_dir), "Several threads")
    assert "the thread that asks" in said and "advance_many" in said


def test_frames_behind_walls_leaps_and_the_fall_of_what_is_grasped_are_those_of_the_run(run_dir: Write) -> None:
    found = made(run_dir, row("maze", OURS, "waiting", 90.0, "frames"), row("hall", OURS, "waiting", 7.0, "frames"),
                 row("maze", OURS, "planning", 4.0, "frames"),
                 row("mug", OURS, "grasped_fall_end", 0.96, "m"),
                 row("mug", "mujoco/tuned", "grasped_fall_end", 0.0, "m"))
    walls = fact(found, "A user who steps")
    assert "101 frames of 2 scenes, most in these: 94 in maze, 7 in hall." in walls and "reset" in walls and "waits" in walls
    assert hasattr(AvatarsimEngine, "put") and "put takes" in walls and "put takes" in fact(found, "A target that leaps")
    assert "5.00 m/s" in fact(found, "A target that leaps") and "reset" in fact(found, "A target that leaps")
    assert f"{OURS} 960 mm; mujoco/tuned 0" in fact(found, "Grabbing")
    assert "sought: in none." in fact(made(run_dir), "A user who steps") and ABSENT in fact(made(run_dir), "Grabbing")


def test_the_slowest_frame_stands_beside_what_a_leap_may_cost(run_dir: Write) -> None:
    said = fact(made(run_dir, row("maze", OURS, "frame_time_max", 5051.0, "us"), row("hall", OURS, "frame_time_max", 40.0, "us")),
                "Every frame")
    assert "5.05 ms, in maze, over 2 of" in said and "every frame that was timed fits" in said
    assert meanings(PostureSettings)["work"] in said, "the page and the settings tell of one budget"
    late = made(run_dir, row("maze", OURS, "frame_time_max", 12e3, "us"))
    assert "in one of them a frame takes longer" in fact(late, "Every frame")
    assert ABSENT in fact(made(run_dir), "Every frame")


def test_the_slowest_frame_says_of_how_many_repeats_it_is_the_least(run_dir: Write) -> None:
    note = "3 x 300 frames, 30 warm-up frames"
    said = fact(made(run_dir, row("maze", OURS, "frame_time_max", 3850.0, "us", note=note),
                     row("hall", OURS, "frame_time_raw_max", 5980.0, "us", note=note)), "Every frame")
    assert "Slowest frame measured, each frame the least of 3 repeats: 3.85 ms, in maze" in said
    assert "In a single repeat, disturbances of the machine included: 5.98 ms, in hall." in said


def test_rates_are_those_measured_and_settings_that_are_per_frame_are_named(run_dir: Write) -> None:
    said = fact(made(run_dir, row("maze", OURS, "tracker_offset_rms", 0.1, "m"),
                     row("refused", "mujoco/tuned", "tracker_offset_rms", 0.1, "m")), "Other frame rates")
    assert "1 at 90 Hz" in said and all(f"{name} {getattr(PostureSettings(), name)}" in said for name in PER_FRAME)
    # all others have a unit, in which no frame occurs
    said_so = {name for name, text in meanings(PostureSettings).items() if "per frame" in text or "a frame" in text}
    assert said_so == set(PER_FRAME)


def test_sizes_carry_a_time_of_this_run_or_none(run_dir: Write) -> None:
    growth = Growth(tuple(Point("avatars", "apart", size, 15 * size, OURS, 9.0 * size, 12.0 * size, "") for size in (10, 3)))
    found = made(run_dir)
    assert "10 avatars (apart): 120 µs at the 95th percentile" in fact(found, "Several avatars", growth)
    assert ABSENT in fact(found, "Several avatars") and ABSENT in fact(found, "Large worlds", growth)
    large = Growth((Point("objects", "idle", 20_000, 20_000, OURS, 9.0, 12.0, ""),))
    assert [word(found, "Large worlds", one) for one in (None, growth, large)] == [UNMEASURED, UNMEASURED, YES]


def test_engines_between_tracker_and_avatar_are_compared_over_scenes_that_all_have(run_dir: Write) -> None:
    rows = [row(scene, run, metric, value, "m")
            for scene, values in (("unseen_a", (0.0, 2e-3, 4e-3)), ("unseen_b", (0.0, 4e-3, 6e-3)))
            for run, value in zip((OURS, "mujoco/tuned", "pybullet/tuned"), values, strict=True)
            for metric in ("residual_overlap_max", "tracker_offset_rms")]
    alone = row("unseen_c", OURS, "residual_overlap_max", 9.0, "m")
    found = made(run_dir, *rows, alone)
    said = fact(found, "Between tracker")
    assert ("Medians of the rooms of untuned motions: deepest overlap shown (in 2) avatarsim/default 0, mujoco/tuned 3.00 mm, "
            "pybullet/tuned 5.00 mm." in said)
    assert "not like for like" in said and ABSENT in fact(made(run_dir, alone), "Between tracker")


def test_a_leap_is_followed_in_part_and_its_figures_stand_there(run_dir: Write) -> None:
    found = made(run_dir, row("teleport", OURS, "tracker_offset_rms", 2.37, "m"),
                 row("teleport", OURS, "reversal_max", 0.306, "m"),
                 row("teleport", "mujoco/tuned", "tracker_offset_rms", 0.755, "m"))
    said = fact(found, "A target that leaps")
    assert "offset from the user, all frames avatarsim/default 2.37 m, mujoco/tuned 755 mm; largest displacement" in said
    assert word(found, "A target that leaps") == PARTLY and "In teleport" not in fact(made(run_dir), "A target that leaps")


def test_ports_and_refused_starts_are_those_of_the_source(run_dir: Write) -> None:
    assert (ROOT / "docs" / "live_ports.md").is_file() and "docs/live_ports.md" in fact(made(run_dir), "C, Unity")
    assert issubclass(StartOverlaps, Exception) and "StartOverlaps" in fact(made(run_dir), "A start inside")
