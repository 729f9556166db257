"""The page of a scene has every setting in force there, with its reason, and leads to what was run in the engine's own words."""

from collections.abc import Callable
from pathlib import Path

from reports import write_report
from reports.page.as_run import as_run
from reports.reading.load import load
from runfiles.naming import COMPILED
from runfiles.native_files import FOLDER
from tests.reports.recorded import scene

Json = dict[str, object]
Write = Callable[[object], Path]
NAME, RUN = "arm_wall", "mujoco/default"


def note(**more: object) -> Json:
    settings = {
        "dt": [0.002, "MuJoCo's documented time step [s]"], f"{COMPILED}geom solref": ["(0.02, 1) x 2", "time constant [s]"],
    }
    return {"name": "mujoco", "preset": "default", "scenario": NAME, "seed": 0, "version": "3.17.0", "cannot_say": {},
            "settings": settings, "recording": "", **more}


def test_settings_and_the_file_of_a_scene_stand_on_its_page_and_numbers_of_one_scene_not_on_the_index(
    run_dir: Write, results: Json
) -> None:
    folder = run_dir(results | {"engines": [note(), note(scenario="ball_drop")]})
    scene(folder, NAME)
    (folder / FOLDER).mkdir()
    (folder / FOLDER / f"{NAME}.mujoco.default.0.xml.gz").write_bytes(b"")
    found = as_run(folder, load(folder), NAME, 0)
    assert [(told.run, told.native) for told in found] == [(RUN, f"../{FOLDER}/{NAME}.mujoco.default.0.xml.gz")]
    assert found[0].settings["dt"] == ("0.002", "MuJoCo's documented time step [s]")
    assert [told.native for told in as_run(folder, load(folder), "ball_drop", 0)] == [""]
    write_report(folder)
    page, index = ((folder / path).read_text(encoding="utf-8") for path in (f"scenes/{NAME}.html", "index.html"))
    assert f'href="{found[0].native}"' in page and "geom solref" in page and "documented time step" in page
    assert "geom solref" not in index and "documented time step" in index


def test_a_scene_without_settings_has_no_such_section(run_dir: Write, results: Json) -> None:
    folder = run_dir(results | {"engines": []})
    scene(folder, NAME)
    assert as_run(folder, load(folder), NAME, 0) == ()
    write_report(folder)
    assert "Settings as run" not in (folder / "scenes" / f"{NAME}.html").read_text(encoding="utf-8")
