"""Which cases are tried in each run of the suite, and which in long campaigns (``-m long``) alone."""

from collections.abc import Callable, Collection, Iterable
from typing import TypeVar

import pytest

from vehicle_sim.parameters import Flavour

T = TypeVar("T")


def sampled(
    names: str | tuple[str, ...], every: Iterable[T], usual: Collection[T], *, ids: Callable[[T], str] | None = None
) -> pytest.MarkDecorator:
    """All of ``every`` as cases of a test; those that are not among the usual ones are for long campaigns.

    Args:
        names: Of the test's arguments; where there are several, a case is a tuple of as many values.
        every: All cases.
        usual: Those of each run of the suite.
        ids: What a case is called, where pytest's name of its values is not it.

    Raises:
        ValueError: What is to be tried always is not among the cases.
    """
    cases = list(every)
    if strange := [case for case in usual if case not in cases]:
        raise ValueError(f"no cases: {strange}")
    one = isinstance(names, str)
    rows = [
        pytest.param(
            *((case,) if one or not isinstance(case, tuple) else case),
            marks=() if case in usual else pytest.mark.long,
            id=ids(case) if ids else None,
        )
        for case in cases
    ]
    return pytest.mark.parametrize(names, rows)


def usually(flavour: Flavour) -> pytest.MarkDecorator:
    """One flavour in each run of the suite, the other in long campaigns: where what is shown is this program's."""
    return sampled("flavour", Flavour, [flavour])


ARDUPILOT, PX4 = usually(Flavour.ARDUPILOT), usually(Flavour.PX4)
EACH = pytest.mark.parametrize("flavour", Flavour)
"""Where flavours differ in what is shown."""
