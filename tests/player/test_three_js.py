"""The script three.js comes from the installed package, whole, with its licence and without the add-ons; or not at all."""

import zipfile
from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from avatarsim.player import three_js


def test_it_is_the_library_alone() -> None:
    found = three_js.library()
    assert found is not None and "SPDX-License-Identifier: MIT" in found[:400]
    assert "WebGLRenderer" in found and "TrackballControls=" not in found and "</script" not in found


@pytest.mark.parametrize("page", [
    None, "", "<script>nothing of the kind</script>", "<script>Three.js Authors</script>\n(function(){",
    "<script>Three.js Authors",
])
def test_anything_else_is_nothing(page: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No such package, no archive, another page, a library that could end its script, one without an end."""
    spec = ModuleSpec("trimesh", None, is_package=True)
    spec.submodule_search_locations = [str(tmp_path)]
    if page:
        place = tmp_path.joinpath(*three_js.ARCHIVE)
        place.parent.mkdir(parents=True)
        with zipfile.ZipFile(place, "w") as archive:
            archive.writestr("viewer.html.template", page)
    monkeypatch.setattr(three_js, "find_spec", lambda name: None if page is None else spec)
    assert three_js.library.__wrapped__() is None
