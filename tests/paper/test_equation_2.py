"""Eq. 2, ee_i = sum_l c_il / k: the mean of the contacts on a link."""

import numpy as np
import pytest

from avatarsim.paper.ccd_ik import end_effector


@pytest.mark.parametrize("count", [1, 2, 7])
def test_it_is_the_mean_of_the_first_k_contacts(count):
    contacts = np.random.default_rng(count).normal(size=(9, 3))
    np.testing.assert_allclose(end_effector(contacts, count), contacts[:count].mean(axis=0), atol=1e-15)
