"""The columns that map and histories share, so that what is pointed at in one is shown in all."""

import numpy as np
from bokeh.models import ColumnDataSource

from mission.report.interactive.scene import Flown

FLOWN = "flown"
"""Name of the source of what was reported: ``t``, ``x``, ``y`` and the columns of the histories."""
CURSOR = "cursor"
"""Name of the source with the one place and time that is pointed at: ``t``, ``x``, ``y``."""


def flown_source(flown: Flown) -> ColumnDataSource:
    """What was reported, for the browser; a live page streams more rows into it."""
    columns = {name: values.astype(np.float32) for name, values in flown.columns.items()}
    east, north = flown.position_m.T.astype(np.float32)
    return ColumnDataSource(data={"t": flown.t_s, "x": east, "y": north, **columns}, name=FLOWN)


def cursor_source(flown: Flown) -> ColumnDataSource:
    """What is pointed at: at first where the vehicle was reported last, as far as that is known."""
    known = np.flatnonzero(np.isfinite(flown.position_m).all(axis=1))[-1:]
    east, north = flown.position_m[known].T
    return ColumnDataSource(data={"t": flown.t_s[known], "x": east, "y": north}, name=CURSOR)
