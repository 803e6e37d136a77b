"""Clocks: a steady one leaves out what a program did not live through."""

from mission.clock import SteadyClock


class Shown:
    """A clock that shows what it is set to."""

    def __init__(self, now: float) -> None:
        self.now = now

    def now_s(self) -> float:
        return self.now


def test_a_steady_clock_goes_on_as_the_other_but_for_its_leaps() -> None:
    shown = Shown(100.0)
    steady = SteadyClock(shown)
    seen = []
    for now in (100.5, 101.5, 3701.5, 3702.0, 90.0, 90.25):
        shown.now = now
        seen.append(steady.now_s())
    assert seen == [100.5, 101.5, 102.5, 103.0, 103.0, 103.25]
    assert steady.left_out_s == 3599.0 + 3612.0
