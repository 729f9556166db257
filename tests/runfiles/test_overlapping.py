"""The judge's pairs come back from their file, deepest first, at most so many per state."""

from pathlib import Path

from runfiles import overlapping

NAMES = ("floor", "box", "hand")


def test_pairs_come_back(tmp_path: Path) -> None:
    pairs = [(), (("hand", "floor", 0.02), ("box", "hand", 0.01)), ()]
    overlapping.write(overlapping.gathered(pairs, NAMES), tmp_path, "a.b.c.0")
    assert overlapping.read(tmp_path, "a.b.c.0", 3, 3) == [(1, 2, 0, 0.02), (1, 1, 2, 0.01)]
    assert overlapping.read(tmp_path, "d.b.c.0", 3, 3) == []


def test_a_heap_keeps_its_deepest_pairs_only() -> None:
    many = tuple(("box", "hand", 1.0 / (k + 1)) for k in range(100))
    found = overlapping.gathered([many], NAMES)
    assert len(found.depth) == overlapping.MAX_PAIRS and found.depth[-1] == 1.0 / overlapping.MAX_PAIRS
