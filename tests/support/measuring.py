"""Times and memory of a function, and bars that figures are held against, for one table.

A bar on time is never a number of seconds, which is a fact about the machine: it is a multiple of what something of
known size takes in the same run, on the same machine, taken in turn with what is measured. Where another library does
the like of it, that is the unit; else a plain loop of Python, or an operation of numpy.
"""

import tracemalloc
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time

from mission.spec.domain import drawn_map


@dataclass(frozen=True)
class Times:
    """Medians over some rounds: by the wall, and of the processor, which others on the machine disturb less."""

    wall_s: float
    processor_s: float


def timed(function: Callable[[], object], rounds: int) -> Times:
    wall_s, processor_s = [], []
    for _ in range(rounds):
        drawn_map.cache_clear()  # what a round found is not at hand in the next one
        begun_s, worked_s = perf_counter(), process_time()
        function()
        processor_s.append(process_time() - worked_s)
        wall_s.append(perf_counter() - begun_s)
    return Times(median(wall_s), median(processor_s))


TURNS: int = 1_000_000


def loop() -> int:
    """A million turns of a plain loop: the unit of what is written in Python."""
    total = 0
    for turn in range(TURNS):
        total += turn & 3
    return total


@dataclass(frozen=True)
class Ratio:
    """How many units a function takes of the processor's time: the median over rounds; and the function's times."""

    units: float
    times: Times


def compared(function: Callable[[], object], unit: Callable[[], object], rounds: int) -> Ratio:
    """Measure a function and its unit in turn, so that both see the machine as it is at that moment."""
    ratios, measured = [], []
    for _ in range(rounds):
        times, yardstick = timed(function, 1), timed(unit, 1)
        measured.append(times)
        ratios.append(times.processor_s / yardstick.processor_s)
    wall_s, processor_s = (
        median(values) for values in zip(*((t.wall_s, t.processor_s) for t in measured), strict=True)
    )
    return Ratio(median(ratios), Times(wall_s, processor_s))


def turn_s() -> float:
    """The processor time of one turn of that loop, now."""
    return timed(loop, 3).processor_s / TURNS


def peak_mb(function: Callable[[], object]) -> float:
    """The most that the function has allocated at once; it runs several times slower meanwhile."""
    tracemalloc.start()
    function()
    peak = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    return peak


def seconds(value: float) -> str:
    return f"{1e3 * value:,.1f} ms" if value < 1.0 else f"{value:,.2f} s"


@dataclass(frozen=True)
class Bar:
    """One row of the table: what was measured, what it is held against, and whether that is met."""

    what: str
    bar: str
    measured: str
    met: bool
    remark: str = ""


def at_most(what: str, measured: int, bar: int) -> Bar:
    return Bar(what, f"at most {bar}", str(measured), measured <= bar)


def at_least(what: str, measured: int, bar: int, remark: str = "") -> Bar:
    return Bar(what, f"at least {bar}", str(measured), measured >= bar, remark)


def within(what: str, measured: Ratio, bar: float, unit: str, remark: str = "") -> Bar:
    """A bar on time: at most so many times as long as the unit, which is named."""
    took = f"{measured.units:,.3g} ({seconds(measured.times.processor_s)})"
    return Bar(what, f"within {bar:g} of {unit}", took, measured.units <= bar, remark)


def table(bars: Iterable[Bar]) -> str:
    """The rows under a head, in columns as wide as they need."""
    rows = [("", "bar", "measured", "met", "")]
    rows += [(bar.what, bar.bar, bar.measured, "yes" if bar.met else "NO", bar.remark) for bar in bars]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return "\n".join([lines[0], "-" * (sum(widths) + 2 * len(widths)), *lines[1:]])
