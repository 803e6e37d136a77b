"""Every run of the suite tries the same examples: a failure is the code's, never a slow machine's, and comes back.

What is there for all tests costs once: the objects that pytest makes of thousands of them are not looked through for
garbage again and again, and each process computes on the core that it has.
"""

import gc
import os
from collections.abc import Generator

import pytest
from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")

for _library in ("OPENBLAS", "OMP", "MKL"):  # read when numpy is imported; by the processes that tests start, too
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is collected stays until the end."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()
