"""Cuts stretches out of logs, and looks for what the whole log gives the lie."""

from dataclasses import replace

import numpy as np

from mission.monitor.gaps import GAP_S
from mission.verify.flown.judging import Judged
from mission.verify.logs.track import Track


def kept(track: Track, gaps: list[tuple[float, float]]) -> Track:
    """Without what was told in these parts of it, from and for a share of its length; begin and end stay."""
    inside = np.ones(len(track.t_s), dtype=np.bool_)
    length_s = track.t_s[-1] - track.t_s[0]
    for begin, share in gaps:
        begin_s, end_s = track.t_s[0] + begin * length_s, track.t_s[0] + (begin + share) * length_s + GAP_S
        inside &= (track.t_s < begin_s) | (track.t_s > end_s)
    inside[[0, -1]] = True
    return replace(track, t_s=track.t_s[inside], position_m=track.position_m[inside])


def contradictions(told: Judged, whole: Judged) -> list[str]:
    """What of a log with gaps the whole log gives the lie."""
    found = []
    if told.achieved is not None and whole.achieved is not None and told.achieved != whole.achieved:
        found.append(f"{told.achieved} ({told.reason}), and it is {whole.achieved} ({whole.reason})")
    if told.achieved and whole.achieved is None:
        found.append("achieved, and nobody knows")
    if told.violations and not whole.violations:
        found.append(f"{told.violations}, and there are none")
    for less, more in zip(told.nearness, whole.nearness, strict=True):
        if not less.surely_m - 1e-6 <= more.least_m <= less.least_m + 1e-6:
            found.append(f"{less}, and it is {more}")
    known = {share.region: share for share in whole.covered}
    for share in told.covered:
        real = known.get(share.region)
        if real is None:  # it was not entered
            continue
        # Tracks are simplified by a thousandth of half a spacing.
        if not share.least - 0.01 <= real.least <= real.most <= share.most + 0.01:
            found.append(f"{share}, and it is {real}")
    return found
