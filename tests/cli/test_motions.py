"""`avatarsim clean` and `avatarsim audit`: their output, exit codes, and folders of anything at all."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

from avatarsim.assets.motions.load import load_motion
from avatarsim.cli import main
from avatarsim.cli.motions import verdict
from avatarsim.clips import certificate
from tests.assets.motions.folded import rows, written
from tests.clips.made import bvh, carrying, content, csv, robot

ROOT = Path(__file__).resolve().parents[2]


def clean(*words: object) -> int:
    return main(["clean", *map(str, words), "--room", "floor", "--workers", "0"])


def ended(*words: object) -> int:
    """Return the exit code, also where argparse ends the process."""
    try:
        return main([*map(str, words)])
    except SystemExit as end:
        return int(str(end.code))


def certified(folder: Path, name: str = "certificate.json") -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / name).read_text())
    jsonschema.validate(found, certificate.schema())
    return found


def test_a_folder_is_cleaned_with_layout_and_certificate(tmp_path: Path) -> None:
    bvh(tmp_path / "in" / "b.bvh", frames=60)
    bvh(tmp_path / "in" / "deep" / "a.bvh", frames=50, seed=1)
    assert clean(tmp_path / "in", "-o", tmp_path / "out") == 0
    assert set(content(tmp_path / "out")) == {
        "b.bvh", "deep/a.bvh", "certificate.json", "index.html", "certificates/b.bvh.json", "certificates/deep/a.bvh.json",
        "pages/b.bvh.html", "pages/three.js", "pages/deep/a.bvh.html",
    }
    whole = certified(tmp_path / "out")
    assert [one["motion"] for one in whole["clips"]] == ["b.bvh", "deep/a.bvh"] and whole["not_done"] == []
    for one in whole["clips"]:
        assert one["is_clean"] and one["overlap"]["before"]["frames"] > 0 and one["overlap"]["after"]["frames"] == 0
        assert 0 < one["changed_frames"] < one["frames"] and one["flagged"]
        json.loads((tmp_path / "out" / f"certificates/{one['motion']}.json").read_text())
    # in the format that it came in, and free frames are unchanged
    before, after = (load_motion(tmp_path / folder / "b.bvh") for folder in ("in", "out"))
    assert (model := before.model()) is not None
    old, new = before.motion(model), after.motion(model)
    assert len(old) == len(new) and (old.positions[0] == new.positions[0]).all()
    assert (old.positions[30] != new.positions[30]).any()


def test_what_is_cleaned_is_found_clean_and_what_was_not_is_not(tmp_path: Path) -> None:
    bvh(tmp_path / "a.bvh")
    audit = ["audit", "--room", "floor", "--workers", "0"]
    assert main([*audit, str(tmp_path / "a.bvh"), "-o", str(tmp_path / "measures")]) == 1
    assert [path.name for path in (tmp_path / "measures").iterdir()] == ["audit.json"]
    certified(tmp_path / "measures", "audit.json")
    assert clean(tmp_path / "a.bvh", "-o", tmp_path / "out") == 0
    before = content(tmp_path)
    assert main([*audit, str(tmp_path / "out" / "a.bvh")]) == 0
    assert content(tmp_path) == before


def test_a_robot_from_its_model_with_a_table_of_coordinates(tmp_path: Path) -> None:
    csv(tmp_path / "a.csv")
    assert clean(tmp_path / "a.csv", "--avatar", robot(tmp_path), "-o", tmp_path / "out", "--no-page", "--rate", "60") == 0
    (one,) = certified(tmp_path / "out")["clips"]
    assert one["rate_hz"] == 60.0 and one["frames"] == 19 and one["overlap"]["before"]["deepest_m"] > 0.02
    assert [file["name"] for file in one["inputs"]["avatar"]] == ["robot.xml"]
    assert not (tmp_path / "out" / "pages").exists()
    assert len((tmp_path / "out" / "a.csv").read_text().splitlines()) == 19


def test_a_robot_is_cleaned_against_the_box_of_its_clip(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, model = carrying(tmp_path / "carry.npz"), robot(tmp_path)
    (tmp_path / "cube.xml").write_text('<mujoco><worldbody><geom type="box" size="1 1 1"/></worldbody></mujoco>')
    shape = ("--object", tmp_path / "cube.xml", "--object-scale", "0.05")
    assert ended("audit", path, "--avatar", model, "--workers", "0") == 0
    assert ended("audit", path, "--avatar", model, "--workers", "0", *shape) == 1
    assert clean(path, "--avatar", model, "-o", tmp_path / "out", *shape) == 0
    (one,) = certified(tmp_path / "out")["clips"]
    assert one["overlap"]["before"]["pair"] == ["stick/arm", "cube"] and one["overlap"]["before"]["frames"] > 0
    assert [file["name"] for file in one["inputs"]["motion"]] == ["carry.npz", "cube.xml"]
    assert one["is_clean"] and one["changed_frames"] > 0
    with np.load(tmp_path / "out" / "carry.npz") as written, np.load(path) as read:
        assert np.array_equal(written["object_pos_w"], read["object_pos_w"]) and not np.array_equal(written["qpos"], read["qpos"])
    assert ended("audit", tmp_path / "out" / "carry.npz", "--avatar", model, "--workers", "0", *shape) == 0
    carrying(tmp_path / "sized.npz", object_size=(0.1, 0.1, 0.1))
    assert ended("audit", tmp_path / "sized.npz", "--avatar", model, "--workers", "0") == 1
    capsys.readouterr()
    csv(tmp_path / "none.csv")
    assert ended("audit", tmp_path / "none.csv", "--avatar", model, "--workers", "0", *shape) == 3
    assert "object" in capsys.readouterr().err
    assert ended("audit", path, "--avatar", model, "--object-scale", "2") == 2


def test_excluded_pairs_and_overlaps_at_home_are_certified(tmp_path: Path) -> None:
    hand = '<body name="hand" pos="-0.1 0 0"><joint name="wrist" range="-1 1"/><geom size="0.05"/></body>'
    tail = '<body name="tail" pos="-0.2 0 0"><joint name="tail" range="-1 1"/><geom size="0.03"/></body>'
    path = robot(tmp_path)
    text = path.read_text().replace("</body>\n    </body>", f"{hand}</body>{tail}</body>")
    path.write_text(text.replace("</worldbody>", '</worldbody><contact><exclude body1="arm" body2="tail"/></contact>'))
    for name in ("in/a.csv", "in/b.csv"):
        rows = csv(tmp_path / name).read_text().splitlines()
        (tmp_path / name).write_text("\n".join(f"{row},0,0" for row in rows) + "\n")
    line = ["audit", str(tmp_path / "in"), "--avatar", str(path), "--workers", "0", "-o", str(tmp_path / "out")]
    main(line)
    for one in certified(tmp_path / "out", "audit.json")["clips"]:
        assert [(pair["a"], pair["b"]) for pair in one["excluded"]] == [("stick/arm", "stick/tail")]
        (pair,) = one["at_rest"]
        assert (pair["a"], pair["b"]) == ("stick/base", "stick/hand") and pair["allowed_m"] > 0.0
    main([*line[:-1], str(tmp_path / "other"), "--exclude", "base:hand"])
    one = certified(tmp_path / "other", "audit.json")["clips"][0]
    assert ("stick/base", "stick/hand") in [(pair["a"], pair["b"]) for pair in one["excluded"]] and one["at_rest"] == []


def test_what_is_done_is_not_done_again_unless_something_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, out = bvh(tmp_path / "in" / "a.bvh"), tmp_path / "out"
    bvh(tmp_path / "in" / "b.bvh", seed=2)
    assert clean(tmp_path / "in", "-o", out) == 0
    first = content(out)

    def again(*more: str) -> set[str]:
        """Return clips that were done anew."""
        capsys.readouterr()
        assert clean(tmp_path / "in", "-o", out, *more) == 0
        lines = capsys.readouterr().out.splitlines()[1:-1]
        return {line.split()[0] for line in lines if not line.endswith("done before")}

    assert again() == set() and content(out) == first
    (out / "a.bvh").write_text("damaged")
    # nothing wrote that but something else
    capsys.readouterr()
    assert clean(tmp_path / "in", "-o", out) == 3
    assert (out / "a.bvh").read_text() == "damaged"
    assert again("--force") == {"a.bvh", "b.bvh"} and content(out) == first
    (out / "a.bvh").unlink()
    (out / "pages" / "b.bvh.html").unlink()
    assert again() == {"a.bvh", "b.bvh"} and content(out) == first
    (out / "certificates" / "b.bvh.json").write_text("{}")
    assert again() == {"b.bvh"} and content(out) == first
    assert again("--margin", "0.002") == {"a.bvh", "b.bvh"} and content(out) != first
    assert again() == {"a.bvh", "b.bvh"} and content(out) == first
    bvh(source, seed=3)
    assert again() == {"a.bvh"}


def test_what_earlier_commands_left_undone_stays_so(tmp_path: Path) -> None:
    out, bad = tmp_path / "out", tmp_path / "bad.bvh"
    bad.write_text("cut off")
    assert clean(bvh(tmp_path / "a.bvh", frames=4), bad, "-o", out) == 3
    # this command has done all its clips
    assert clean(bvh(tmp_path / "b.bvh", frames=4), "-o", out) == 0
    assert [(one["name"], one["kind"]) for one in certified(out)["not_done"]] == [("bad.bvh", "unreadable")]
    bvh(bad, frames=4)
    assert clean(bad, "-o", out) == 0 and certified(out)["not_done"] == []
    # one that got worse is not done, beside its earlier result
    bad.write_text("cut off")
    assert clean(bad, "-o", out) == 3 and clean(tmp_path / "b.bvh", "-o", out) == 0
    assert [one["name"] for one in certified(out)["not_done"]] == ["bad.bvh"]
    assert [one["motion"] for one in certified(out)["clips"]] == ["a.bvh", "b.bvh", "bad.bvh"]
    assert "1 not done" in (out / "index.html").read_text("utf-8")
    bvh(bad, frames=4)
    whole = certificate.MARK + "damaged"
    (out / "certificate.json").write_text(whole)
    assert clean(bad, "-o", out) == 0 and certified(out)["not_done"] == []


@pytest.mark.parametrize("frames", [1, 2])
@pytest.mark.parametrize("sinks", [-0.3, 0.2])
def test_the_shortest_clips_are_cleaned_too(tmp_path: Path, frames: int, sinks: float) -> None:
    path = bvh(tmp_path / "a.bvh", frames=3, sinks=sinks)
    head, _, rows = path.read_text().partition("Frames: 3")
    # from its deepest frame on
    step, *lines = rows.strip().splitlines()
    path.write_text("\n".join([f"{head}Frames: {frames}", step, *lines[1 : 1 + frames]]) + "\n")
    assert clean(path, "-o", tmp_path / "out", "--no-opinion") == 0
    (one,) = certified(tmp_path / "out")["clips"]
    assert one["frames"] == frames and (one["rate_hz"] is None) == (frames == 1) and one["between_frames"]["chords"] == frames - 1
    assert (one["overlap"]["before"]["frames"] > 0) == (sinks > 0.0) and one["second_opinion"] == {"before": None, "after": None}


def rubbish(folder: Path) -> dict[str, str]:
    """Return files that no reader takes, with the message for each."""
    good = bvh(folder / "good.bvh").read_text()
    (folder / "cut.bvh").write_text(good[: len(good) // 3])
    (folder / "empty.bvh").write_bytes(b"")
    (folder / "binary.bvh").write_bytes(bytes(range(256)) * 40)
    (folder / "nan.bvh").write_text(good.replace("0.000000", "nan", 1))
    (folder / "table.csv").write_text("a,b\n1,x\n")
    (folder / "zip.npz").write_bytes(b"PK\3\4rubbish")
    (folder / "clip.txt").write_text('{"Frames": [[1, 2]]}')
    (folder / "motion.pkl").write_bytes(b"\x80\x04cos\nsystem\n.")
    (folder / "alone.amc").write_text("#!OML\n:DEGREES\n1\nroot 0 0 0 0 0 0\n")
    os.mkfifo(folder / "pipe.bvh")
    (folder / "gone.bvh").symlink_to(folder / "nowhere")
    return {"motion.pkl": "pickle", "pipe.bvh": "pipe", "gone.bvh": "No such file", "empty.bvh": "empty.bvh"}


def test_a_folder_of_rubbish_is_named_and_the_rest_is_done(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    said = rubbish(folder)
    (folder / "NOTES.md").write_text("notes")
    assert clean(folder, tmp_path / "missing.bvh", "-o", tmp_path / "out") == 3
    _, err = capsys.readouterr()
    whole = certified(tmp_path / "out")
    assert [one["motion"] for one in whole["clips"]] == ["good.bvh"]
    refused = {one["name"]: one["why"] for one in whole["not_done"]}
    assert set(refused) == {path.name for path in folder.iterdir()} - {"good.bvh", "NOTES.md"} | {"missing.bvh"}
    assert [name for name, words in said.items() if words not in refused[name]] == []
    assert [name for name in refused if f"avatarsim: {name}: " not in err] == [] and "Traceback" not in err
    assert set(content(tmp_path / "out")) == {
        "good.bvh", "certificate.json", "index.html", "certificates/good.bvh.json", "pages/good.bvh.html", "pages/three.js",
    }


NAMES = ["<img src=x onerror=alert(1)>.bvh", "a&b \"c\" 'd'.bvh", "line\nbreak\x1b[31m.bvh", "über 漢.bvh", "100%#?.bvh",
         "bad\udcff.bvh"]


def test_names_from_anywhere_are_data_and_nothing_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for k, name in enumerate(NAMES):
        bvh(tmp_path / "in" / name, frames=4, seed=k)
    assert clean(tmp_path / "in", "-o", tmp_path / "out") == 0
    out, err = capsys.readouterr()
    assert "\x1b" not in out + err and "\udcff" not in out
    assert sorted(os.listdir(tmp_path / "in")) == sorted(path.name for path in (tmp_path / "out").glob("*.bvh"))
    pages = [path.read_text("utf-8") for path in (tmp_path / "out").rglob("*.html")]
    assert len(pages) == len(NAMES) + 1
    for page in pages:
        assert "<img" not in page and "\x1b" not in page
    assert "100%25%23%3F.bvh.html" in (tmp_path / "out" / "index.html").read_text("utf-8")
    certified(tmp_path / "out")


CLEAN = ["clean", "a.bvh", "-o", "out"]


@pytest.mark.parametrize(("words", "said"), [
    (["clean"], "required"), (["clean", "a.bvh"], "-o/--out"), (["clean", "a.bvh", "-o", ""], "empty name"),
    ([*CLEAN, "--no-such"], "--no-such"), ([*CLEAN, "--up", "x"], "--up"), ([*CLEAN, "--margin", "wide"], "--margin"),
    ([*CLEAN, "--scheduler", "nowhere"], "--scheduler"),
    (["clean", "a.bvh", "-o", "a.bvh"], "output folder"), (["clean", "a.bvh", "-o", "a.bvh/b"], "output folder"),
    (["clean", "a.bvh", "-o", "/proc/out"], "output folder"), (["clean", "a.bvh", "-o", "."], "no file that is read"),
    (["clean", "empty", "-o", "out"], "folders with clips"), (["audit"], "required"), (["audit", "a.bvh", "--force"], "--force"),
    ([*CLEAN, "--avatar", "x.xml", "--exclude", "a"], "--exclude"),
    (["tidy"], "tidy"), ([*CLEAN, "--fix", "all"], "beside --avatar"),
    ([*CLEAN, "--keyframe", "home"], "beside --avatar or --room"), ([*CLEAN, "--fit", "0.1"], "beside --avatar or --room"),
    ([*CLEAN, "--room-up", "y"], "beside --room"),
])
def test_wrong_usage_is_a_sentence_and_code_2(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("avatarsim.running.cluster.ANSWERS_WITHIN", 0.5)
    bvh(tmp_path / "a.bvh", frames=2)
    (tmp_path / "empty").mkdir()
    before = content(tmp_path)
    assert ended(*words) == 2
    err = capsys.readouterr().err
    assert said in err and "Traceback" not in err
    assert {name: one for name, one in content(tmp_path).items() if name in before} == before
    assert not (tmp_path / "out" / "a.bvh").exists()


@pytest.mark.parametrize(("name", "code"), [("index.html", 2), ("certificate.json", 2), ("pages/a.bvh.html", 3), ("a.bvh", 3)])
def test_files_of_other_programs_stay(tmp_path: Path, name: str, code: int) -> None:
    clip, place = bvh(tmp_path / "a.bvh", frames=4), tmp_path / "out" / name
    place.parent.mkdir(parents=True)
    place.write_text("mine")
    assert ended("clean", clip, "-o", tmp_path / "out", "--room", "floor", "--workers", "0") == code
    assert place.read_text() == "mine"
    assert clean(clip, "-o", tmp_path / "out", "--force") == 0 and place.read_text() != "mine"
    # now it is ours
    assert clean(clip, "-o", tmp_path / "out") == 0 and clean(clip, "-o", tmp_path / "out", "--margin", "0.002") == 0
    (tmp_path / "audit.json").write_text("mine")
    assert ended("audit", clip, "-o", tmp_path) == 2 and (tmp_path / "audit.json").read_text() == "mine"


def test_a_full_disk_costs_no_earlier_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert clean(bvh(tmp_path / "a.bvh", frames=4), "-o", tmp_path / "out") == 0
    before, clip = content(tmp_path / "out"), bvh(tmp_path / "b.bvh", frames=4)

    def full(*words: object) -> None:
        raise OSError(28, "No space left on device")

    # full when the clip is to be written
    monkeypatch.setattr("avatarsim.clips.task.put", full)
    assert clean(clip, "-o", tmp_path / "out") == 3
    whole = ("certificate.json", "index.html")
    after = content(tmp_path / "out")
    assert {name: one for name, one in after.items() if name not in whole} == {
        name: one for name, one in before.items() if name not in whole}
    assert [one["name"] for one in certified(tmp_path / "out")["not_done"]] == ["b.bvh"]


BARE = """
import sys
for name in ("coacd", "coal", "distributed", "joblib", "jsonschema", "mujoco", "pandas", "pebble", "tqdm", "trimesh", "viser"):
    sys.modules[name] = None
from avatarsim.cli import main
from avatarsim.cli.motions import verdict
sys.exit(main(sys.argv[1:]) or main(sys.argv[1:]))
"""


def test_bvh_on_level_ground_needs_no_extra(tmp_path: Path) -> None:
    bvh(tmp_path / "in" / "a.bvh", frames=4)
    line = [sys.executable, "-c", BARE, "clean", str(tmp_path / "in"), "--room", "floor", "-o", str(tmp_path / "out")]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert [row.partition("  ")[2].split("  ")[-1] for row in done.stdout.splitlines() if row.startswith("a.bvh")] == [
        "clean", "clean, done before"]


def test_an_audit_tells_limits_from_overlap(tmp_path: Path) -> None:
    csv(tmp_path / "deep.csv")
    still = [["0", "0", "2", "0", "0", "0", "1", angle] for angle in ("0", "0.1", "0.1")]
    (tmp_path / "bent.csv").write_text("\n".join(map(",".join, still)) + "\n")
    (tmp_path / "good.csv").write_text("\n".join(",".join([*row[:-1], "0.01"]) for row in still) + "\n")
    clips = [str(tmp_path / f"{name}.csv") for name in ("deep", "bent", "good")]
    words = ["audit", *clips, "--avatar", str(robot(tmp_path)), "--room", "floor", "--workers", "0", "-o", str(tmp_path / "out")]
    assert main(words) == 1
    found = {one["motion"]: one for one in certified(tmp_path / "out", "audit.json")["clips"]}
    verdicts = {name: verdict(one) for name, one in found.items()}
    assert verdicts == {"deep.csv": "OVERLAPS", "bent.csv": "BEYOND LIMITS", "good.csv": "clean"}
    deepest = found["deep.csv"]["overlap"]["before"]
    assert deepest["frame"] in (4, 5) and deepest["pair"] and found["bent.csv"]["overlap"]["before"]["frame"] is None


def test_a_home_is_a_frame_as_it_was_recorded_or_a_file(tmp_path: Path) -> None:
    """Also at another rate, where the output has no such frame."""
    clip, other = written(tmp_path, "a.bvh", rows()), written(tmp_path, "b.bvh", rows()[:9])
    for home, word in (("29", "29"), (f"{other}:4", "b.bvh:4")):
        out = tmp_path / f"out{len(home)}"
        assert clean(clip, "-o", out, "--rate", "40", "--home", home, "--no-page", "--no-opinion") == 0
        (one,) = certified(out)["clips"]
        assert one["options"]["reading"]["home"] == word and one["frames"] < 29
    assert ended("audit", clip, "--home", "30", "--workers", "0") == 3
    assert ended("audit", clip, "--home", "nowhere", "--workers", "0") == 2
