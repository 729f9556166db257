"""The judge's pairs come back from their file, deepest first, at most so many per state."""

from pathlib import Path

from runfiles import array_file, overlapping

NAMES = ("floor", "box", "hand")


def test_pairs_come_back(tmp_path: Path) -> None:
    pairs = [(), (("hand", "floor", 0.02), ("box", "hand", 0.01)), ()]
    overlapping.write(overlapping.gathered(pairs, NAMES), tmp_path, "a.b.c.0")
    found = array_file.read(tmp_path / overlapping.FOLDER / "a.b.c.0.npz")
    assert found["frame"].tolist() == [1, 1] and found["depth"].tolist() == [0.02, 0.01]
    assert found["first"].tolist() == [2, 1] and found["second"].tolist() == [0, 2]


def test_a_heap_keeps_its_deepest_pairs_only() -> None:
    many = tuple(("box", "hand", 1.0 / (k + 1)) for k in range(100))
    found = overlapping.gathered([many], NAMES)
    assert len(found.depth) == overlapping.MOST and found.depth[-1] == 1.0 / overlapping.MOST
