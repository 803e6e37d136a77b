"""Times and memory of a function, and bars that figures are held against, for one table."""

import tracemalloc
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time


@dataclass(frozen=True)
class Times:
    """Medians over some rounds: by the wall, and of the processor, which others on the machine disturb less."""

    wall_s: float
    processor_s: float


def timed(function: Callable[[], object], rounds: int) -> Times:
    wall_s, processor_s = [], []
    for _ in range(rounds):
        begun_s, worked_s = perf_counter(), process_time()
        function()
        processor_s.append(process_time() - worked_s)
        wall_s.append(perf_counter() - begun_s)
    return Times(median(wall_s), median(processor_s))


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


def within(what: str, measured_s: float, bar_s: float, remark: str = "") -> Bar:
    return Bar(what, f"within {seconds(bar_s)}", seconds(measured_s), measured_s <= bar_s, remark)


def table(bars: Iterable[Bar]) -> str:
    """The rows under a head, in columns as wide as they need."""
    rows = [("", "bar", "measured", "met", "")]
    rows += [(bar.what, bar.bar, bar.measured, "yes" if bar.met else "NO", bar.remark) for bar in bars]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return "\n".join([lines[0], "-" * (sum(widths) + 2 * len(widths)), *lines[1:]])
