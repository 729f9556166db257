"""The page on the server's side: effect of a drag into a table on the scene that viewers get."""

import re
import threading
import time
from collections.abc import Callable, Iterator

import pytest

pytest.importorskip("viser")

from avatarsim.engine import Settings
from avatarsim.live.drive.driver import Driver
from avatarsim.live.messages import Plan
from avatarsim.live.recording import ENGINE
from avatarsim.live.session import Session
from avatarsim.live.stages import stage
from avatarsim.live.view.depth import own_depth
from avatarsim.live.view.page import Page, Shows
from avatarsim.live.view.share import driven, shared_page

SECONDS = 60.0


def soon(is_true: Callable[[], bool]) -> bool:
    """Return True once a condition is met, False if it is not met for long."""
    end = time.monotonic() + SECONDS
    while not is_true() and time.monotonic() < end:
        time.sleep(0.05)
    return is_true()


def inside(page: Page) -> list[float]:
    """Return the overlaps over the scene [mm]."""
    return [float(found) for found in re.findall(r'data-overlap="([^"]*)"', page.panel.numbers.content)]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """Yield the page of the hand over the table, with its rounds running, for the tests of this file one after the other."""
    found, is_over = stage("hand"), threading.Event()
    beside = Plan(ENGINE, found.scene, Settings(preset="paper"), 60.0, name="other")
    with Session([Plan(ENGINE, found.scene, Settings(), 60.0)]) as session:
        shows = Shows(found, {}, own_depth(found.scene), port=0, folder=tmp_path_factory.mktemp("page"), offered=[beside])
        one = Page(session, Driver(found.scene), shows)
        rounds = threading.Thread(target=lambda: one.rounds(is_over.is_set))
        rounds.start()
        yield one
        is_over.set()
        rounds.join()
        one.close()


def test_a_hand_in_the_table_has_a_ghost_and_two_numbers(page: Page) -> None:
    ghost, first = page.worlds.meshes["avatarsim"].ghost, page.session.scene.first_sample.positions[0]
    assert soon(lambda: inside(page) == [0.0, 0.0] and page.hint.visible)
    assert not any(body.node.visible for body in ghost.values())
    page.post(lambda: page.driver.drag("hand/palm", (*first[:2], 0.74)))
    assert soon(lambda: inside(page)[0] > 5.0 and any(body.node.visible for body in ghost.values()))
    assert inside(page)[1] == 0.0 and not page.hint.visible
    assert b"startPlayer" in shared_page(page.session.scene, driven(page.session), {}), "the last seconds are a page"


def test_another_engine_beside_follows_the_same_drag(page: Page) -> None:
    page.post(lambda: page.compare("other"))
    assert soon(lambda: len(inside(page)) == 3)
    link, first = page.session.scene.names.index("hand/palm"), page.session.scene.first_sample.positions[0]
    page.post(lambda: page.driver.drag("hand/palm", first + (0.1, 0.0, 0.0)))
    assert soon(lambda: all(state.positions[link, 0] > first[0] + 0.09 for state in page.session.states.values()))
    assert set(page.session.states) == set(page.worlds.meshes) == {"avatarsim", "other"}
    page.post(lambda: page.compare("other"))
    assert soon(lambda: len(inside(page)) == 2 and set(page.worlds.meshes) == {"avatarsim"})
