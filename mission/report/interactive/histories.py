"""Histories: plots over one axis of time, with bands for regions and phases, and the time that is pointed at."""

from collections.abc import Iterable

import numpy as np
from bokeh.layouts import gridplot
from bokeh.models import ColumnDataSource, GridPlot, HoverTool, Legend, Range1d, Title, VSpan, VStrip
from bokeh.plotting import figure

from mission.printable import printable
from mission.report.interactive.scene import Band, History, Timeline
from mission.report.palette import BLACK, QUIET, VERMILLION, WHITE

_ROW_PX, _STRIP_PX, _LEFT_PX = 132, 96, 58
_TOOLS = "xpan,xwheel_zoom,xbox_zoom,reset"
_STRIP_ROWS = ("phase", "region")
_SHORTEST_S = 1.0
_ROOM_FOR_A_LEGEND = 0.35
_LETTERS = 75
"""So many of the strip's letters stand beside each other on a narrow screen; longer texts show when pointed at."""


def histories_of(timeline: Timeline, flown: ColumnDataSource, cursor: ColumnDataSource) -> GridPlot:
    """Draw histories, one under the other, with one axis of time.

    Their names are ``history_names``.

    Args:
        timeline: What is drawn, and the bands behind it.
        flown: As ``flown_source`` makes it, with the columns that the histories name.
        cursor: As ``cursor_source`` makes it.
    """
    t_s = np.asarray(flown.data["t"])
    bands = (*timeline.regions, *timeline.phases)
    begin = float(min([*t_s[:1], *(band.from_s for band in bands)], default=0.0))
    end = float(max([*t_s[-1:], *(band.to_s for band in bands), begin + _SHORTEST_S]))
    shown = Range1d(begin, end, bounds=(begin, end))
    plots = [_strip(timeline, shown, cursor)]
    plots += [_history(each, timeline.regions, shown, flown, cursor) for each in timeline.histories]
    for plot, name in zip(plots, history_names(timeline), strict=True):
        plot.name = name
    plots[-1].xaxis.axis_label = "time of the vehicle, s"
    plots[-1].height += 24
    for plot in plots[:-1]:
        plot.xaxis.major_label_text_font_size = "0px"
        plot.xaxis.major_tick_line_color = None
        plot.xaxis.minor_tick_line_color = None
    grid = gridplot([[plot] for plot in plots], toolbar_location="above", merge_tools=True, sizing_mode="stretch_width")
    grid.toolbar.logo = None
    return grid


def history_names(timeline: Timeline) -> list[str]:
    """The names of the plots, from top to bottom."""
    return [f"history {number}" for number in range(1 + len(timeline.histories))]


def _strip(timeline: Timeline, shown: Range1d, cursor: ColumnDataSource) -> figure:
    """When the vehicle was where, and what it was doing, in two rows."""
    plot = _empty(shown, _STRIP_PX)
    plot.y_range = Range1d(0.0, 2.0)
    for row, bands in enumerate((timeline.phases, timeline.regions)):
        source = _source(bands)
        source.data["shown"] = [
            text if fits else "" for text, fits in zip(source.data["text"], _fits(bands, shown), strict=True)
        ]
        quads = plot.quad(
            "from",
            "to",
            row + 0.92,
            row + 0.08,
            source=source,
            fill_color="colour",
            fill_alpha=0.45,
            line_color=QUIET,
            line_width=0.6,
        )
        plot.text(
            "from",
            row + 0.5,
            "shown",
            source=source,
            text_baseline="middle",
            text_font_size="11px",
            text_color=BLACK,
            x_offset=3,
        )
        plot.add_tools(HoverTool(renderers=[quads], tooltips="@text", visible=False))
    plot.yaxis.ticker = [0.5, 1.5]
    plot.yaxis.major_label_overrides = {0.5 + row: name for row, name in enumerate(_STRIP_ROWS)}
    plot.ygrid.grid_line_color = None
    _draw_cursor(plot, cursor)
    return plot


def _fits(bands: Iterable[Band], shown: Range1d) -> list[bool]:
    letters_per_s = _LETTERS / max(shown.end - shown.start, 1e-9)
    return [len(band.text) <= (band.to_s - band.from_s) * letters_per_s for band in bands]


def _history(
    history: History, regions: Iterable[Band], shown: Range1d, flown: ColumnDataSource, cursor: ColumnDataSource
) -> figure:
    plot = _empty(shown, _ROW_PX)
    plot.add_layout(
        Title(text=f"{history.title}, {history.unit}", text_font_size="12px", text_font_style="normal"), "above"
    )
    plot.add_glyph(_source(regions), VStrip(x0="from", x1="to", fill_color="colour", fill_alpha=0.16, line_alpha=0.0))
    for trace in history.traces:
        plot.line(
            "t",
            trace.column,
            source=flown,
            line_color=trace.colour,
            line_width=trace.width,
            line_dash=trace.dash,
            line_join="round",
            **({"legend_label": trace.label} if len(history.traces) > 1 or history.bounds else {}),
        )
    for bound in history.bounds:
        ends, level = [shown.start, shown.end], [bound.value, bound.value]
        plot.line(ends, level, line_color=QUIET, line_width=1.4, line_dash="dashed", legend_label=bound.label)
    if history.from_zero:
        plot.y_range.start = 0.0
    if plot.legend:
        plot.y_range.range_padding = _ROOM_FOR_A_LEGEND
    _place_legend(plot.legend)
    _draw_cursor(plot, cursor)
    return plot


def _place_legend(legends: Iterable[Legend]) -> None:
    for legend in legends:
        legend.orientation = "horizontal"
        legend.location = "top_right"
        legend.label_text_font_size = "11px"
        legend.padding, legend.margin, legend.spacing = 1, 2, 8
        legend.glyph_height = legend.label_height = 12
        legend.border_line_color = None
        legend.background_fill_alpha = 0.75


def _empty(shown: Range1d, height_px: int) -> figure:
    plot = figure(
        x_range=shown,
        height=height_px,
        sizing_mode="stretch_width",
        tools=_TOOLS,
        active_scroll=None,
        toolbar_location=None,
        min_border_left=_LEFT_PX,
        min_border_right=8,
        background_fill_color=WHITE,
    )
    plot.yaxis.ticker.desired_num_ticks = 4
    plot.yaxis.minor_tick_line_color = None
    plot.grid.grid_line_color = "#E4E4E4"
    plot.yaxis.major_label_text_font_size = plot.xaxis.major_label_text_font_size = "11px"
    return plot


def _draw_cursor(plot: figure, cursor: ColumnDataSource) -> None:
    plot.add_glyph(cursor, VSpan(x="t", line_color=VERMILLION, line_width=1.5), level="overlay")


def _source(bands: Iterable[Band]) -> ColumnDataSource:
    rows = tuple(bands)
    return ColumnDataSource(
        {
            "from": [band.from_s for band in rows],
            "to": [band.to_s for band in rows],
            "text": [printable(band.text) for band in rows],
            "colour": [band.colour for band in rows],
        }
    )
