"""NumPy archives: arrays come back unchanged, equal arrays are equal bytes, and hostile ones are refused unread."""

import io
import pickle
import struct
import tracemalloc
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of

from avatarsim.assets import caps
from avatarsim.assets.motions.archive import FLOAT32_MOST, Archive, narrowed, npz_bytes, open_archive
from avatarsim.errors import InvalidFile
from tests.assets.motions.robots import saved

ANY = st.dictionaries(
    st.text("abcdefgh_", min_size=1, max_size=12),
    arrays_of.arrays(
        st.sampled_from(["<f8", "<f4", ">f8", "<i4", "|b1", "<U3", "|S4"]),
        arrays_of.array_shapes(min_dims=0, max_dims=3, min_side=0),
    ),
    max_size=4,
)


def header(text: str) -> bytes:
    """Return an .npy file of version 1 with the header `text`."""
    padded = text.encode("latin-1") + b" " * (117 - len(text)) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(padded)) + padded


def zipped(path: Path, members: dict[str, bytes], kind: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", kind) as file:
        for name, content in members.items():
            file.writestr(name, content)
    return path


@contextmanager
def memory_below(most: int) -> Iterator[None]:
    """Check that Python's own memory grows by at most so many bytes meanwhile."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < most
    finally:
        tracemalloc.stop()


@given(ANY, st.booleans())
def test_arrays_come_back_in_value_type_and_order(arrays: dict[str, Any], compressed: bool) -> None:
    content = npz_bytes(arrays, compressed)
    with np.load(io.BytesIO(content), allow_pickle=False) as theirs:
        assert list(theirs) == list(arrays)
        for key, values in arrays.items():
            assert theirs[key].dtype == values.dtype and theirs[key].tobytes() == values.tobytes()
    assert npz_bytes(arrays, compressed) == content


@given(ANY, st.sampled_from([np.savez, np.savez_compressed]))
def test_what_numpy_wrote_is_read(
    tmp_path_factory: pytest.TempPathFactory, arrays: dict[str, Any], save: Callable[..., None]
) -> None:
    path = tmp_path_factory.mktemp("archive") / "some.npz"
    save(path, **arrays)
    found = open_archive(path)
    assert list(found.arrays) == list(arrays) and found.left_out == ()
    for key, values in arrays.items():
        assert found.arrays[key].dtype == values.dtype and found.arrays[key].tobytes() == values.tobytes()
    assert found.compressed == (bool(arrays) and save is np.savez_compressed)


def test_python_objects_are_left_out_and_never_made(tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self) -> tuple[Any, ...]:
            return (Path.touch, (tmp_path / "sprung",))

    np.savez(tmp_path / "some.npz", poses=np.array([Trap()], dtype=object), trans=np.zeros((2, 3)))
    found = open_archive(tmp_path / "some.npz")
    assert found.left_out == ("poses",) and list(found.arrays) == ["trans"]
    with pytest.raises(InvalidFile, match=r"poses in some\.npz.*pickle.*numpy\.asarray"):
        found.table("poses")
    assert not (tmp_path / "sprung").exists()


def bomb(folder: Path) -> Path:
    """Return a few hundred kilobytes that unpack to more than the limit."""
    path = folder / "hostile.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file, file.open("poses.npy", "w", force_zip64=True) as entry:
        entry.write(header(f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({caps.BYTES // 8},), }}"))
        for _ in range(caps.BYTES // 2**22):
            entry.write(bytes(2**22))
    return path


def liar(folder: Path) -> Path:
    """Return an archive that states a smaller length of its entry than the true one."""
    whole = header("{'descr': '<f8', 'fortran_order': False, 'shape': (4096,), }") + bytes(32768)
    path = zipped(folder / "hostile.npz", {"a.npy": whole})
    raw = path.read_bytes()
    size = struct.pack("<I", 32768 + 128)
    assert raw.count(size) == 2
    path.write_bytes(raw.replace(size, struct.pack("<I", 160)))
    return path


def said(text: str, rest: int = 64) -> Callable[[Path], Path]:
    return lambda folder: zipped(folder / "hostile.npz", {"a.npy": header(text) + bytes(rest)})


def raw(content: bytes) -> Callable[[Path], Path]:
    def made(folder: Path) -> Path:
        (folder / "hostile.npz").write_bytes(content)
        return folder / "hostile.npz"

    return made


def cut(folder: Path) -> Path:
    path = saved(folder / "hostile.npz", {"a": np.arange(100.0)})
    path.write_bytes(path.read_bytes()[:-30])
    return path


def flipped(folder: Path) -> Path:
    """Return an archive with a changed number, so that the checksum is wrong."""
    path = saved(folder / "hostile.npz", {"a": np.arange(100.0)})
    content = bytearray(path.read_bytes())
    content[400] ^= 255
    path.write_bytes(bytes(content))
    return path


def many(folder: Path) -> Path:
    whole = header("{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }") + bytes(8)
    return zipped(folder / "hostile.npz", {f"a{k}.npy": whole for k in range(caps.ENTRIES + 1)})


def twice(folder: Path) -> Path:
    whole = header("{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }") + bytes(8)
    with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(folder / "hostile.npz", "w") as file:
        file.writestr("a.npy", whole)
        file.writestr("a.npy", whole)
    return folder / "hostile.npz"


HOSTILE: dict[str, tuple[Callable[[Path], Path], str]] = {
    "zip bomb": (bomb, "unpacked size"),
    "size in the archive is a lie": (liar, "bytes of a in hostile|damaged"),
    "1e9 frames claimed": (
        said("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000, 36), }"), "bytes of a.*288000000000"),
    "shape below nought": (said("{'descr': '<f8', 'fortran_order': False, 'shape': (-2, -4), }"), "damaged|bytes of a"),
    "shape of a text": (said("{'descr': '<f8', 'fortran_order': False, 'shape': 'x', }"), "header"),
    "shape beyond all": (said("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 10**30), }"), "header"),
    "empty but endless": (said(f"{{'descr': '<f8', 'fortran_order': False, 'shape': (0, {10**30}), }}", 0), "damaged"),
    "nested header": (said("[" * 100), "header"),
    "record type": (said("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (8,), }"), "type of a"),
    "complex numbers": (said("{'descr': '<c16', 'fortran_order': False, 'shape': (4,), }"), "type of a"),
    "text of no length": (said("{'descr': '<U0', 'fortran_order': False, 'shape': (4,), }", 0), "damaged"),
    "version 9": (lambda folder: zipped(folder / "hostile.npz", {"a.npy": b"\x93NUMPY\x09\x00" + bytes(20)}), "version|header"),
    "no array": (lambda folder: zipped(folder / "hostile.npz", {"a.npy": b"hello"}), "header"),
    "not an npy": (lambda folder: zipped(folder / "hostile.npz", {"../../a.sh": b"hello"}), "entry of|name of"),
    "long name": (lambda folder: zipped(folder / "hostile.npz", {"a" * 300 + ".npy": b""}), "name of an entry"),
    "no name": (lambda folder: zipped(folder / "hostile.npz", {".npy": b""}), "name of an entry"),
    "many entries": (many, "entries of"),
    "an entry twice": (twice, "entry of"),
    "other packing": (lambda folder: zipped(folder / "hostile.npz", {"a.npy": b"hello"}, zipfile.ZIP_LZMA), "packing of a"),
    "empty file": (raw(b""), "damaged or no archive"),
    "a pickle called npz": (raw(pickle.dumps({"a": 1})), "damaged or no archive"),
    "text": (raw(b"x,y,z\n1,2,3\n" * 100), "damaged or no archive"),
    "cut off": (cut, "damaged or no archive"),
    "a number changed": (flipped, "damaged or no archive"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_archives_end_in_a_sentence(tmp_path: Path, name: str) -> None:
    make, says = HOSTILE[name]
    path = make(tmp_path)
    # reading allocates for the largest file that may be read; nothing is unpacked into more
    with memory_below(caps.BYTES + 2**24), pytest.raises(InvalidFile, match=says) as caught:
        open_archive(path)
    assert "hostile.npz" in str(caught.value)


def archive(**arrays: Any) -> Archive:
    return Archive("some.npz", {key: np.asarray(values) for key, values in arrays.items()}, False, ())


@pytest.mark.parametrize(("values", "says"), [
    (np.zeros(3), "shape of a"), (np.zeros((2, 4)), r"shape of a.*\(frames, 3\)"), (np.zeros((0, 3)), "shape of a"),
    (np.full((2, 3), "1"), "type of a"), (np.zeros((2, 3), dtype=complex), "type of a"),
    (np.zeros((2, 3), dtype=bool), "type of a"),
    (np.array([[0.0, 1.0, 2.0], [0.0, np.nan, 1.0]]), "column 1 of frame 1 of a in some.npz"),
    (np.full((2, 3), np.inf), "column 0 of frame 0"), (np.zeros((caps.FRAMES + 1, 3), dtype=np.float16), "frames of some"),
])
def test_entries_that_are_no_table_are_refused(values: Any, says: str) -> None:
    with pytest.raises(InvalidFile, match=says):
        archive(a=values).table("a", 3)


def test_entries_are_read_as_what_they_are() -> None:
    found = archive(a=np.arange(6, dtype=np.int32).reshape(2, 3), fps=[50], names=["x", "y"], raw=[b"x", b"y"])
    assert found.table("a", 3).tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert found.scalar("fps") == 50.0
    assert found.words("names") == found.words("raw") == ("x", "y")
    assert found.first(("b", "fps", "a")) == "fps" and found.first(("b",)) is None
    questions: tuple[tuple[str, Callable[[str], object], str], ...] = (
        ("a", found.scalar, "one number"), ("a", found.words, "row of names"), ("b", found.table, "entries of"),
        ("fps", found.table, "shape of fps"),
    )
    for key, ask, says in questions:
        with pytest.raises(InvalidFile, match=says):
            ask(key)
    for bad in (["x" * 300], ["a\nb"], [""], [["x"]]):
        with pytest.raises(InvalidFile, match="names"):
            archive(names=bad).words("names")


@pytest.mark.parametrize(("like", "most", "found"), [
    ("<f4", 1.0, "<f4"), ("<f4", FLOAT32_MOST, "<f4"), ("<f4", FLOAT32_MOST + 0.1, "<f8"), ("<f2", 1.0, "<f8"),
    ("<i8", 1.0, "<f8"),
    ("<f8", 100.0, "<f8"), (">f4", 1.0, ">f4"),
])
def test_numbers_keep_the_files_type_where_it_is_fine_enough(like: str, most: float, found: str) -> None:
    values = np.array([0.1, -most])
    written = narrowed(values, np.zeros(2, dtype=like))
    assert written.dtype == np.dtype(found)
    assert np.abs(written.astype(np.float64) - values).max() < 2.5e-7


def test_columns_first_comes_back_in_shape(tmp_path: Path) -> None:
    values = np.asfortranarray(np.arange(12.0).reshape(3, 4))
    assert (open_archive(saved(tmp_path / "some.npz", {"a": values})).arrays["a"] == values).all()
