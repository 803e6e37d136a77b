"""Every run of the suite tries the same examples: a failure is the code's, never a slow machine's, and comes back.

What is there for all tests costs once: the objects that pytest makes of thousands of them are not looked through for
garbage again and again, and each process computes on the core that it has.
"""

import gc
import os
from collections.abc import Generator

import pytest
from hypothesis import settings

from tests.support.drawn_cases import EVERY, USUAL

settings.register_profile("usual", derandomize=True, deadline=None, max_examples=USUAL)
settings.register_profile("campaign", settings.get_profile("usual"), max_examples=EVERY)
settings.load_profile("usual")

for _library in ("OPENBLAS", "OMP", "MKL"):  # read when numpy is imported; by the processes that tests start, too
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")


def pytest_configure(config: pytest.Config) -> None:
    """Read before the tests are, which ask for their share of the examples then."""
    if _is_campaign(config):
        settings.load_profile("campaign")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Tests with drawn examples try a share of them in each run of the suite, and all in long campaigns."""
    if _is_campaign(config):
        for item in items:
            if getattr(getattr(item, "obj", None), "is_hypothesis_test", False):
                item.add_marker("long")


def _is_campaign(config: pytest.Config) -> bool:
    return bool(config.getoption("markexpr") == "long")


@pytest.fixture
def every_setpoint(monkeypatch: pytest.MonkeyPatch) -> None:
    """Records have every setpoint, not only those that the others do not follow from."""
    monkeypatch.setattr("mission.fly.recording._SETPOINT_S", 0.0)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is collected stays until the end; it is not frozen, for Hypothesis asks the collector who holds what."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
