"""What the table says of scenes in which the other engine is nearer."""

from dataclasses import replace
from math import nan

from scenarios.beside.pair import Among, Beside
from scenarios.beside.table import known, table

ALL, NONE = Among(10, 0.02, 0.01, 1.0, 1.0), Among(0, nan, nan, nan, nan)
FAIR = Beside("fair", 10, 10, 0.02, 0.01, 1.0, 1.0, 0.0, 0.02, 0.01, ALL, ALL, "")
OTHERWISE = Among(4, 0.01, 0.02, 1.0, 1.0)
BENT = replace(FAIR, scenario="bent", body=0.01, their_body=0.02, kept=OTHERWISE)
BEYOND = replace(
    FAIR, scenario="beyond", angle=25.0, their_angle=15.0, least_angle=23.0, offset=0.0, unsaid="reach cones; twist",
    alike=replace(ALL, angle=25.0, their_angle=15.0),
)


def test_a_fair_loss_is_a_loss() -> None:
    assert known(FAIR) == ("theirs is nearer with all of the body", "")


def test_nearer_only_by_leaving_limits() -> None:
    assert known(BENT) == (
        "only where it leaves the joints' limits, not in the 4 of 10 frames in which it keeps them; "
        "ours is nearer with all of the body", "",
    )
    assert known(replace(BENT, kept=NONE))[0].startswith("it keeps the joints' limits in no frame; ")


def test_nearer_only_where_loose_bodies_are_elsewhere() -> None:
    assert known(replace(FAIR, alike=OTHERWISE))[0] == (
        "only where loose bodies are elsewhere than in ours, not in the 4 of 10 frames in which they are within 10 mm; "
        "theirs is nearer with all of the body"
    )
    assert known(replace(FAIR, alike=NONE))[0].startswith("its loose bodies are elsewhere than in ours in every frame; ")


def test_nearer_than_any_posture_within_limits() -> None:
    offset, angle = known(BEYOND)
    assert offset == "" and angle == (
        "no posture within the joints' limits has less than 23.0 deg; theirs is nearer with all of the body; "
        "it cannot say in full: reach cones; twist"
    )
    # as near as the bound is no breach
    assert not known(replace(BEYOND, their_angle=23.0))[1].startswith("no posture")


def test_a_line_per_scene_and_per_loss() -> None:
    lines = table([FAIR, BENT, BEYOND], "other.tuned").splitlines()
    assert [line.split()[0] for line in lines[3:6]] == ["fair", "bent", "beyond"]
    assert "body, scenes by who is nearer: ours 1, theirs 2, same 0, - 0" in lines
    losses = lines[lines.index("Where other.tuned is nearer:") + 1 :]
    assert [line.split(":")[0] for line in losses] == ["  fair, offset", "  bent, offset", "  beyond, angle"]
    assert "Where" not in table([replace(FAIR, offset=0.0)], "other.tuned")
