"""Every status has its own number and its own name."""

from avatarsim.collision import status


def test_every_status_is_named_once():
    values = [v for k, v in vars(status).items() if k.isupper() and isinstance(v, int)]
    assert sorted(values) == sorted(status.NAMES)
    assert len(set(status.NAMES.values())) == len(values)
