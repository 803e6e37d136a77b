"""How much of the regions that are to be covered a flight covered: at least, and at most."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely

from mission.coverage.flown import covered_share, swath
from mission.monitor.gaps import GAP_S
from mission.verify.flown.reach import Reaches


@dataclass(frozen=True, eq=False)
class ToCover:
    """A region that is to be covered.

    Attributes:
        region: Its name.
        area: What of it may be entered, metres.
        spacing_m: What is within half of this counts as covered.
        share: How much of it is asked for.
        visited: Whether it was entered for certain; else it may have been, and nothing of it need be covered.
    """

    region: str
    area: shapely.Geometry
    spacing_m: float
    share: float
    visited: bool


@dataclass(frozen=True)
class CoveredShare:
    """What was covered of a region.

    Attributes:
        region: Its name.
        least: The share that was covered for certain, from 0 to 1.
        most: The share that may have been.
        asked: The share that is asked for.
        visited: Whether it was entered for certain.
    """

    region: str
    least: float
    most: float
    asked: float
    visited: bool

    @property
    def enough(self) -> bool | None:
        """Whether that is as much as is asked for; None where it cannot be told."""
        if self.least >= self.asked:
            return True
        return None if self.most >= self.asked or not self.visited else False


def covered_shares(reaches: Reaches, regions: Iterable[ToCover], *, whole: bool) -> tuple[CoveredShare, ...]:
    """What was covered of each region: wherever the vehicle was counts, for nobody knows what it was for.

    Args:
        reaches: The reports, and how far the vehicle may have been off between them.
        regions: Those that are to be covered.
        whole: Whether the log has the flight from begin to end.
    """
    gaps = [reaches.area(index) for index in np.flatnonzero(reaches.is_gap).tolist()]
    return tuple(_share(reaches, region, gaps, whole=whole) for region in regions)


def _share(reaches: Reaches, region: ToCover, gaps: list[shapely.Geometry], *, whole: bool) -> CoveredShare:
    covered = swath(reaches.position_m, reaches.t_s, spacing_m=region.spacing_m, longest_gap_s=GAP_S)
    least = covered_share(region.area, covered)
    if not whole:
        return CoveredShare(region.region, least, 1.0, region.share, region.visited)
    if not gaps:
        return CoveredShare(region.region, least, least, region.share, region.visited)
    perhaps = shapely.union_all([covered, *shapely.buffer(gaps, region.spacing_m / 2.0)])
    return CoveredShare(region.region, least, covered_share(region.area, perhaps), region.share, region.visited)
