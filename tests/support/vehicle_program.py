"""The vehicle program as a process of its own, on free ports."""

import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

PROGRAM = [sys.executable, "-m", "vehicle_sim"]


@contextmanager
def running(*options: str) -> Iterator[tuple["subprocess.Popen[str]", list[str]]]:
    """Start the program on free ports; give the process and the addresses that it announces."""
    process = subprocess.Popen(  # noqa: S603 - this project's own program
        [*PROGRAM, "--announce", "--quiet", *options],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert select.select([process.stdout], [], [], 60.0)[0], "no announcement"
        word, *addresses = process.stdout.readline().split()
        assert word == "READY", process.communicate()[1]
        yield process, addresses
    finally:
        process.kill()
        process.communicate()
