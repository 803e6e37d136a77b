"""Versions of the client and flavours of the vehicle: each in every run of the suite, all pairs in long campaigns."""

from collections.abc import Mapping
from itertools import product

import pytest

from tests.clients.environments import VERSIONS
from tests.support.usual_cases import sampled
from vehicle_sim.parameters import Flavour


def paired(usual: Mapping[int, Flavour]) -> pytest.MarkDecorator:
    """Which flavour each version is tried on in every run of the suite."""
    return sampled(("version", "flavour"), product(VERSIONS, Flavour), list(usual.items()))
