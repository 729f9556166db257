"""Bodies taken, pinched, carried and released in a driven world; doors and lifts; and recordings of all of it."""

from pathlib import Path
from random import Random

import numpy as np
import pytest

from avatarsim.engine import Settings, Snapshot
from avatarsim.live.drive.driver import Driver
from avatarsim.live.drive.keys import KEYS
from avatarsim.live.messages import Command, Order, Plan, Switch
from avatarsim.live.orders import World
from avatarsim.live.ports.protocol import Shape, parse
from avatarsim.live.recording import ENGINE, Recorder, read
from avatarsim.live.replaying import replay
from avatarsim.live.stages import stage
from avatarsim.scene.body import Role
from avatarsim.scene.tracker import TrackerSample
from avatarsim.tolerances import JUDGED
from reference.judging.judge import Judge
from scenarios import catalog

DT = 1.0 / 60.0


def on_stage(name: str) -> tuple[World, Driver]:
    """Return the world of a built-in stage and its driver."""
    scene = stage(name).scene
    return World(Plan(ENGINE, scene, Settings(), 60.0)), Driver(scene)


def deepest(world: World, shown: list[Snapshot]) -> float:
    """Return the deepest overlap [m] of some states by the judge."""
    return Judge(world.scene).deepest(np.array([one.positions for one in shown]), np.array([one.orientations for one in shown]))


def place_of(world: World, name: str) -> np.ndarray:
    """Return the shown place of a body [m]."""
    return np.asarray(world.shown.shown.positions[world.scene.names.index(name)])


def test_a_mug_is_taken_by_a_key_carried_and_let_go() -> None:
    world, driver = on_stage("toys")
    at = place_of(world, "mug")
    assert "nothing loose" in world.apply(Command(Order.TAKE))
    for _ in range(60):
        driver.drag("hand/palm", at + (-0.09, 0.0, 0.06))
        world.advance(driver.tick(DT))
    assert world.apply(Command(Order.TAKE)) == "" and world.report == "took mug"
    for _ in range(60):
        driver.drag("hand/palm", at + (-0.1, 0.0, 0.3))
        world.advance(driver.tick(DT))
    assert place_of(world, "mug")[2] > at[2] + 0.15
    assert world.apply(Command(Order.TAKE)) == "" and world.report == "let go of mug"
    for _ in range(60):
        world.advance(driver.tick(DT))
    assert place_of(world, "mug")[2] < at[2] + 0.05


def pinching() -> tuple[World, list[TrackerSample]]:
    """Return a world and samples of three fingers that close on a mug, and open again."""
    scenario = catalog.get("mug_in_fingers")
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    closing = [motion(frame) for frame in range(40)]
    return World(Plan(ENGINE, scene, Settings(), 60.0)), [*closing, *reversed(closing)]


def test_what_is_pinched_is_attached_until_the_fingers_open() -> None:
    world, samples = pinching()
    assert world.apply(Command(Order.PINCH, True)) == ""
    held = []
    for sample in samples:
        world.advance(sample)
        held.append(bool(world.engine.attached()))  # type: ignore[attr-defined]
    assert not held[0] and held[40] and not held[-1]


def test_recordings_hold_what_was_taken_and_pinched(tmp_path: Path) -> None:
    world, samples = pinching()
    recorder = Recorder(tmp_path / "a.live", world.plan, world.shown.state_hash())
    for frame, sample in enumerate(samples):
        for at, order, value in ((0, Order.PINCH, True), (50, Order.KEEP, None), (60, Order.BACK, None), (45, Order.TAKE, None)):
            if frame == at:
                command = Command(order, value)
                assert world.apply(command) == ""
                recorder.command(command)
        recorder.frame(sample, world.advance(sample).state_hash())
    recorder.close()
    done = replay(read(tmp_path / "a.live"))
    assert done.difference is None and done.frames == len(samples)


@pytest.mark.parametrize("seed", [1, 5])
def test_hands_that_take_at_random_stay_finite_and_free(seed: int) -> None:
    """Bodies attached to several links of one hand meet one another where no joint lets them yield."""
    random, (world, driver) = Random(seed), on_stage("toys")
    scene = world.scene
    loose = [body.name for body in scene.bodies if body.role is Role.SIMULATED]
    links, pulled, shown = scene.names[len(scene.bodies):], "", list[Snapshot]()
    goal = np.zeros(3)
    for frame in range(160):
        if frame % 40 == 0:
            if pulled:
                driver.release(pulled)
            goal = place_of(world, random.choice(loose)) + [random.uniform(-0.05, 0.05) for _ in range(3)]
            pulled = random.choice(links)
        driver.drag(pulled, goal)
        if frame % 15 == 0:
            driver.press(random.choice(KEYS).key)
        if random.random() < 0.06:
            world.apply(Command(Order.TAKE))
        shown.append(world.advance(driver.tick(DT)).shown)
    assert all(np.isfinite(one.velocities).all() for one in shown)
    assert deepest(world, shown) <= JUDGED


@pytest.mark.parametrize(("name", "seed"), [("hand", 5), ("gallery", 1), ("toys", 3)])
def test_random_drives_into_loose_bodies_come_to_an_end(name: str, seed: int) -> None:
    """No island is joined and left by others until its segments are spent, and a human that is pressed moves on."""
    random, (world, driver) = np.random.default_rng(seed), on_stage(name)
    loose = [b for b, body in enumerate(world.scene.bodies) if body.role is Role.SIMULATED]
    link, shortened, substeps = "", 0, 0
    for frame in range(300):
        if frame % 45 == 0:
            if link:
                driver.release(link)
            near = np.clip(world.shown.shown.positions[random.choice(loose)], -3.0, 3.0)
            goal = near + random.uniform(-0.15, 0.15, 3)
            link = driver.links[random.integers(len(driver.links))]
        driver.drag(link, goal)
        if frame % 15 == 0:
            driver.press(KEYS[random.integers(len(KEYS))].key)
        record = world.advance(driver.tick(DT))
        assert not any(status.startswith("motion") for status in record.statuses)
        shortened, substeps = shortened + record.counts["ways_shortened"], substeps + record.counts["substeps"]
    assert substeps > 0 and (name != "gallery" or shortened < 0.1 * substeps)


def test_pinching_ends_where_a_switch_allows_no_holding() -> None:
    world, samples = pinching()
    world.apply(Command(Order.PINCH, True))
    assert world.apply(Command(Order.SWITCH, Switch((), "paper"))) == ""
    for sample in samples[:45]:
        world.advance(sample)
    assert not world.pinches


def test_a_switch_of_the_method_keeps_what_is_held() -> None:
    world, samples = pinching()
    world.apply(Command(Order.PINCH, True))
    for sample in samples[:40]:
        world.advance(sample)
    held = dict(world.engine.attached())  # type: ignore[attr-defined]
    assert world.apply(Command(Order.SWITCH, Switch((), "default", {"spring": 900.0}))) == ""
    assert held and world.engine.attached() == held  # type: ignore[attr-defined]


def test_a_human_walks_through_the_door_and_raises_the_lift() -> None:
    world, driver = on_stage("house")
    for frame in range(540):
        if frame % 10 == 0:
            assert driver.press("i" if frame < 420 else "y") == ""
        world.advance(driver.tick(DT))
    assert place_of(world, "human/pelvis")[0] > 1.0
    assert abs(world.shown.angles[-1]) > 1.0
    assert place_of(world, "lift")[2] > 0.4
    assert place_of(world, "box on the lift")[2] == pytest.approx(place_of(world, "lift")[2] + 0.225, abs=1e-3)


def test_a_human_carries_a_box_through_the_door() -> None:
    (world, driver), shown = on_stage("house"), list[Snapshot]()

    def drag(link: str, place: tuple[float, float, float], frames: int) -> None:
        for _ in range(frames):
            driver.drag(link, place)
            shown.append(world.advance(driver.tick(DT)).shown)
        driver.release(link)

    drag("human/right_hand", (-1.05, -0.8, 0.95), 150)
    assert world.apply(Command(Order.TAKE)) == "" and world.report == "took box"
    drag("human/right_hand", (-1.3, -0.4, 1.25), 90)
    drag("human/pelvis", (-1.6, 0.0, 1.0), 120)
    for frame in range(360):
        if frame % 10 == 0:
            driver.press("i")
        shown.append(world.advance(driver.tick(DT)).shown)
    assert place_of(world, "box")[0] > 1.5 and abs(world.shown.angles[-1]) > 1.0
    assert deepest(world, shown) <= JUDGED


def test_trackers_tell_of_all_but_moving_bodies() -> None:
    scene = stage("house").scene
    shape, driver = Shape.of(scene), Driver(scene)
    assert "lift" not in shape.links and "lift" in shape.handles
    start, links = scene.first_sample, len(shape.links)
    driver.set_sample(TrackerSample(0.0, start.positions[:links], start.rotations[:links], start.angles[: shape.hinges]))
    assert len(driver.tick(DT).positions) == links + 2
    goals = parse('{"links": {"lift": {"position": [2.6, -1.6, 0.5]}}}', shape)
    assert set(goals.links) == {"lift"}  # type: ignore[union-attr]
