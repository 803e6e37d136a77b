"""How many examples Hypothesis draws in each run of the suite, and how many in long campaigns (``-m long``)."""

from collections.abc import Collection
from math import ceil
from typing import Final

from hypothesis import HealthCheck, Phase, settings

EVERY: Final = 100
"""Of a test that says nothing of their number, in long campaigns."""
USUAL: Final = 15
"""And in each run of the suite."""
FEW: Final = 8
"""Where a test asks for no more, all are tried in each run."""


def tried(
    examples: int, *, suppress_health_check: Collection[HealthCheck] = (), phases: Collection[Phase] = tuple(Phase)
) -> settings:
    """So many drawn examples in long campaigns, and the usual share of them in each run of the suite.

    Args:
        examples: Of the test in a long campaign.
        suppress_health_check: As of Hypothesis.
        phases: As of Hypothesis.
    """
    share = settings().max_examples / EVERY
    return settings(
        max_examples=max(min(examples, FEW), ceil(share * examples)),
        suppress_health_check=tuple(suppress_health_check),
        phases=tuple(phases),
    )
