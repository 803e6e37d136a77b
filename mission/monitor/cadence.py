"""How regularly setpoints were sent, and how much longer the trajectory took than planned."""

from array import array
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.monitor.gaps import GAP_S

_TOLD_S: Final = 1.0
"""What a flight is slower by that is worth a word."""

_LATE_S: Final = 0.2
"""A delay of the link, likewise."""


@dataclass(frozen=True)
class Cadence:
    """Of one flight, in vehicle time.

    Attributes:
        setpoints: How many were sent.
        median_gap_s: Half of the times between two of them are no longer.
        p99_gap_s: Nor are 99 of 100 longer than this.
        largest_gap_s: The longest.
        slowed_s: What the trajectory took beyond its own time, but for its pauses.
    """

    setpoints: int = 0
    median_gap_s: float = 0.0
    p99_gap_s: float = 0.0
    largest_gap_s: float = 0.0
    slowed_s: float = 0.0

    @property
    def text(self) -> str:
        """The gaps in plain words."""
        half, most, longest = (1e3 * gap_s for gap_s in (self.median_gap_s, self.p99_gap_s, self.largest_gap_s))
        return f"setpoints every {half:.0f} ms, 99 % within {most:.0f} ms, the longest gap {longest:.0f} ms"

    def values(self) -> dict[str, float]:
        """The same for a record."""
        return {name: round(value, 4) for name, value in vars(self).items()}


NONE_SENT: Final = Cadence()


class CadenceWatch:
    """Takes each setpoint as it is sent."""

    def __init__(self) -> None:
        """None was sent yet."""
        self._gaps = array("d")
        self._last: tuple[float, float | None] | None = None
        self._slowed_s = 0.0

    def note(self, t_s: float, trajectory_s: float | None) -> None:
        """Take a setpoint for a vehicle time; ``trajectory_s`` is None where no trajectory is flown."""
        if self._last is not None:
            gap_s, before_s = t_s - self._last[0], self._last[1]
            self._gaps.append(gap_s)
            # A trajectory that begins anew is another one, of a flight whose plan was changed.
            if trajectory_s is not None and before_s is not None and gap_s <= GAP_S and trajectory_s >= before_s:
                self._slowed_s += max(gap_s - (trajectory_s - before_s), 0.0)
        self._last = (t_s, trajectory_s)

    @property
    def cadence(self) -> Cadence:
        """What has come of it up to now."""
        if not self._gaps:
            return Cadence(int(self._last is not None))
        gaps = np.frombuffer(self._gaps)
        median_s, p99_s = (float(found) for found in np.quantile(gaps, (0.5, 0.99), method="inverted_cdf"))
        return Cadence(len(gaps) + 1, median_s, p99_s, float(gaps.max()), self._slowed_s)


def slowed_text(cadence: Cadence, link_delay_s: float) -> str:
    """That the trajectory was flown more slowly, in plain words; empty where it was not, or hardly."""
    if cadence.slowed_s < _TOLD_S:
        return ""
    link = f", over a link that takes {link_delay_s:.1f} s there and back" if link_delay_s >= _LATE_S else ""
    return f"the trajectory took {cadence.slowed_s:.0f} s longer, for the vehicle to keep up{link}"
