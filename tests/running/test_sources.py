"""Facts of a process about its run: sources by their hash, versions, and the folder that it sees."""

from pathlib import Path

from avatarsim.running.sources import SAME, about, code_hash, digest_of, version, versions


def test_a_digest_knows_every_source_file_by_name_and_content(tmp_path: Path) -> None:
    (tmp_path / "room" / "deep").mkdir(parents=True)
    (tmp_path / "other").mkdir()
    (tmp_path / "room" / "a.py").write_text("x = 1\n")
    first = digest_of(tmp_path, ["room"])
    (tmp_path / "other" / "b.py").write_text("y = 1\n")
    (tmp_path / "room" / "notes.txt").write_text("no source\n")
    assert digest_of(tmp_path, ["room"]) == first and len(first) == 16
    found = {first, digest_of(tmp_path, ["room", "other"])}
    (tmp_path / "room" / "deep" / "c.py").write_text("x = 1\n")
    found.add(digest_of(tmp_path, ["room"]))
    (tmp_path / "room" / "a.py").write_text("x = 2\n")
    found.add(digest_of(tmp_path, ["room"]))
    assert len(found) == 4


def test_a_process_says_what_it_has_in_common_with_others(tmp_path: Path) -> None:
    told = about(tmp_path)
    assert set(SAME) <= set(told) and told["code"] == code_hash() and told["daemon"] is False
    assert told == about(tmp_path) and told["folder"] != about(tmp_path / "absent")["folder"]
    assert version("no-such-distribution") is None and versions(["numpy"])["numpy"] == version("numpy")
