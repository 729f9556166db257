"""Arrays come back bit by bit, smooth ones take little room, and a file that is damaged or blown up is an InvalidFile."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from runfiles import array_file

RNG = np.random.default_rng(11)
ODD = np.array([np.nan, -np.nan, 0.0, -0.0, np.inf, -np.inf, 5e-324, -1.7976931348623157e308, 1.0])
ARRAYS = {
    "numbers": RNG.normal(size=(7, 2, 3)),
    "odd": ODD,
    "nothing": np.zeros((0, 4, 3)),
    "no bodies": np.zeros((5, 0, 3)),
    "one": np.array([3.5]),
    "column major": np.asfortranarray(RNG.normal(size=(4, 3))),
    "every other": np.arange(10.0)[::2],
    "whole": np.array([2**63 - 1, -(2**63), 0, -1, 1]),
    "counts:pairs": np.arange(6),
    "texts": np.array(["a", "bb"]),
    "alone": np.array("text"),
    "flags": np.array([True, False]),
    "small": np.arange(3, dtype=np.float32),
    "scalar": np.array(2.0),
}


def written(path: Path, arrays: dict[str, np.ndarray]) -> Path:
    with path.open("wb") as file:
        array_file.write(file, arrays)
    return path


def test_arrays_come_back_bit_by_bit_and_stay_as_they_were(tmp_path: Path) -> None:
    before = {name: array.tobytes() for name, array in ARRAYS.items()}
    found = array_file.read(written(tmp_path / "a.npz", ARRAYS))
    assert list(found) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert (found[name].dtype, found[name].shape) == (array.dtype, array.shape), name
        assert found[name].tobytes() == array.tobytes() == before[name], name
        assert found[name].flags.writeable, name


def test_only_what_is_wanted_is_read(tmp_path: Path) -> None:
    path = written(tmp_path / "a.npz", ARRAYS)
    assert list(array_file.read(path, {"odd", "texts"}.__contains__)) == ["odd", "texts"]


def test_a_smooth_course_takes_half_the_room(tmp_path: Path) -> None:
    t = np.linspace(0.0, 3.0, 600)
    course = np.stack([np.sin(t + k) for k in range(30)], axis=1)
    plain = io.BytesIO()
    np.savez_compressed(plain, course=course)
    size = written(tmp_path / "a.npz", {"course": course}).stat().st_size
    assert size < 0.75 * course.nbytes and size < 0.8 * len(plain.getvalue())


def test_a_damaged_file_is_an_invalid_file_or_whole(tmp_path: Path) -> None:
    """Bits turned over anywhere, in every part of the file's anatomy."""
    whole = written(tmp_path / "a.npz", ARRAYS).read_bytes()
    refused = 0
    for k in range(600):
        spoilt = bytearray(whole)
        for at in RNG.integers(0, len(whole), size=1 + k % 4):
            spoilt[at] ^= 1 << int(RNG.integers(8))
        path = tmp_path / "b.npz"
        path.write_bytes(bytes(spoilt))
        try:
            array_file.read(path)
        except InvalidFile as error:
            assert "b.npz" in str(error)
            refused += 1
    assert refused > 300


@pytest.mark.parametrize("content", [b"", b"PK", b"no archive at all", b"PK\x05\x06" + bytes(18)])
def test_what_is_no_archive_is_an_invalid_file(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(content)
    if content.startswith(b"PK\x05"):
        assert array_file.read(path) == {}
        return
    with pytest.raises(InvalidFile, match="a.npz"):
        array_file.read(path)


def member(path: Path, name: str, header: str, data: bytes) -> Path:
    """Write a file with one member and any header."""
    text = header.encode().ljust(117) + b"\n"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + data)
    return path


@pytest.mark.parametrize(
    ("name", "header", "data"),
    [
        ("x", "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,)}", bytes(64)),
        ("x", "{'descr': '<f8', 'fortran_order': False, 'shape': (2,)}", bytes(64)),
        ("x", "{'descr': '<f8', 'fortran_order': False, 'shape': (-8,)}", bytes(64)),
        ("x", "{'descr': '|O', 'fortran_order': False, 'shape': (8,)}", bytes(64)),
        ("x", "{'descr': '<f8', 'fortran_order': True, 'shape': (8,)}", bytes(64)),
        ("x", "{'descr': '<f8', 'fortran_order': False, 'shape': (((((", bytes(64)),
        ("x@float64", "{'descr': '|u1', 'fortran_order': False, 'shape': (64,)}", bytes(64)),
        ("x@float64", "{'descr': '|u1', 'fortran_order': False, 'shape': (4, 16)}", bytes(64)),
        ("x@float64", "{'descr': '<f8', 'fortran_order': False, 'shape': (8, 1)}", bytes(64)),
    ],
)
def test_a_header_that_lies_is_an_invalid_file(tmp_path: Path, name: str, header: str, data: bytes) -> None:
    with pytest.raises(InvalidFile, match="a.npz"):
        array_file.read(member(tmp_path / "a.npz", name, header, data))


def test_too_large_a_file_is_refused_before_it_is_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of 73 kB that unpacks to 16 MB, with room for 8; and the same spread over members that are small each."""
    one = written(tmp_path / "one.npz", {"x": np.zeros(2**21)})
    many = written(tmp_path / "many.npz", {f"x{k}": np.zeros(2**17) for k in range(16)})
    assert one.stat().st_size < 2**17
    monkeypatch.setattr(array_file, "MAX_BYTES", 2**23)
    monkeypatch.setattr(zipfile.ZipFile, "open", lambda *rest, **named: pytest.fail("a member was unpacked"))
    for path in (one, many):
        with pytest.raises(InvalidFile, match=f"size of .*{path.name} unpacked"):
            array_file.read(path)
