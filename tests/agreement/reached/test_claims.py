"""No entry of the table of what engines are known to reach leads nowhere, and no test of it is left out."""

from pathlib import Path

import pytest

from reference.narrow_phase.field import ROOMS, contenders
from runfiles.metrics import unit
from scenarios import catalog
from scenarios.results.results import is_time
from tests.agreement.reached.claims import HERE, KNOWN, Claim
from tests.agreement.reached.unmatched import UNMATCHED
from tests.named_tests import exists, names_in
from tests.scenarios.studies.settings.grids import GRIDS

SETTINGS = {setting.run for settings in GRIDS.values() for setting in settings}
THERE, ABSENT = contenders(ROOMS)


@pytest.mark.parametrize("claim", KNOWN, ids=[claim.says for claim in KNOWN])
def test_every_test_scene_setting_contender_and_time_that_is_named_exists(claim: Claim) -> None:
    assert claim.tests or claim.sweep or claim.contenders or claim.times
    assert [entry for entry in claim.tests if not exists(entry)] == []
    assert set(claim.scenes) <= set(catalog.scenarios())
    assert set(claim.sweep) <= SETTINGS
    assert all(is_time(metric) and unit(metric) for metric in claim.times)
    assert ABSENT or set(claim.contenders) <= {contender.identity.name for contender in THERE}


def test_every_test_beside_the_table_is_in_it() -> None:
    files = [file.name for file in Path(__file__).parent.glob("test_*.py") if file.name != Path(__file__).name]
    wanted = {f"{HERE}{file}::{name}" for file in files for name in names_in(HERE + file)}
    assert wanted == {entry for claim in KNOWN for entry in claim.tests if entry.startswith(HERE)}


def test_what_is_not_matched_has_a_reason() -> None:
    assert all(len(why) > 20 for why in UNMATCHED.values())
    assert not set(UNMATCHED) & {claim.says for claim in KNOWN}
