"""Map and histories as a piece of a page that stands alone: the library's script, the figures, and what links them."""

import json
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import Any, Final

import numpy as np
from bokeh.document import Document
from bokeh.resources import Resources

from mission.printable import printable
from mission.report.interactive.chart_map import FLOWN_LABEL, layer_colours, map_of, moving_columns
from mission.report.interactive.histories import histories_of, history_names
from mission.report.interactive.scene import Band, Flown, Scene, Timeline
from mission.report.interactive.sources import cursor_source, flown_source
from mission.report.markup import escape
from mission.report.palette import FLOWN

MAP_ID: Final = "map"
HISTORIES_ID: Final = "histories"
_DOCUMENT: Final = "flight"
_NO_SCRIPT: Final = (
    "<noscript><p>Map and histories need scripts; the tables and pictures of this page do not.</p></noscript>"
)


@cache
def scripts() -> str:
    """What the page runs: the library, and what links the figures."""
    library = Resources(mode="inline", components=["bokeh"]).js_raw
    return "".join(f"<script>\n{script}\n</script>\n" for script in (*library, moving_script(), _script("linking.js")))


def moving_script() -> str:
    """What moves on maps is shown by this."""
    return _script("moving.js")


def _script(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def figures(scene: Scene, flight: tuple[Flown, Timeline] | None) -> str:
    """The map, and the histories of a flight, as elements of a page with words beside them; ``scripts`` come before.

    Args:
        scene: What the map shows beside the flown path.
        flight: What was reported and what is drawn of it over time; None for a plan that was not flown.
    """
    flown, timeline = flight or (Flown(np.empty(0), np.empty((0, 2)), {}), Timeline())
    source, cursor = flown_source(flown), cursor_source(flown)
    roots = {MAP_ID: map_of(scene, source, cursor)}
    if flight is not None:
        roots[HISTORIES_ID] = histories_of(timeline, source, cursor)
    document = Document()
    for root in roots.values():
        document.add_root(root)
    told = {
        "documents": {_DOCUMENT: document.to_json(deferred=False)},
        "items": [
            {
                "docid": _DOCUMENT,
                "roots": {root.id: name for name, root in roots.items()},
                "root_ids": [root.id for root in roots.values()],
            }
        ],
        **_told(timeline),
        "histories": [] if flight is None else history_names(timeline),
        **({"moving": {**moving, "begun": timeline.begun_s}} if (moving := moving_of(scene)) else {}),
    }
    histories = "" if flight is None else _histories(flown, timeline)
    parts = [
        '<div id="flight">',
        f"<section><h2>Map</h2>{_NO_SCRIPT}{_switches(scene, flown=flight is not None)}",
        f"{_plot(MAP_ID, 'Map', _map_in_words(scene))}</section>",
        histories,
        "</div>",
        f'<script type="application/json" id="figures">{_json(told)}</script>',
        "<script>MissionPage.open();</script>",
    ]
    return "\n".join(filter(None, parts))


def moving_of(scene: Scene) -> dict[str, Any]:
    """What the script that shows what moves is told; empty where nothing moves."""
    sources = moving_columns(scene)
    return {"times": [*scene.instants_s], "sources": sources} if sources else {}


def _histories(flown: Flown, timeline: Timeline) -> str:
    words = _histories_in_words(flown, timeline)
    return f"<section><h2>Histories</h2>{_slider(len(flown.t_s))}{_plot(HISTORIES_ID, 'Histories', words)}</section>"


def _map_in_words(scene: Scene) -> str:
    """What the map shows, for those who do not see it."""
    areas = ", ".join(f"{area.name} ({area.kind.value})" for area in scene.areas)
    near = "; ".join(f"{each.name} {each.distance_m:.2f} m" for each in scene.nearest)
    return (f"Regions: {areas}. " if areas else "") + (f"Least distance of the flight to {near}." if near else "")


def _histories_in_words(flown: Flown, timeline: Timeline) -> str:
    """Between which values each quantity was."""
    ranges = []
    for history in timeline.histories:
        values = flown.columns[history.traces[0].column]
        # Zero is added for there is no zero below zero.
        least, most = (round(float(end(values)), history.digits) + 0.0 for end in (np.nanmin, np.nanmax))
        ranges.append(f"{history.title}: {least:.{history.digits}f} to {most:.{history.digits}f} {history.unit}")
    return f"Point at a time, or use the slider, and the map shows the place. {'. '.join(ranges)}."


def _told(timeline: Timeline) -> dict[str, Any]:
    """What is said in words of the time that is pointed at."""
    quantities = [
        {
            "column": history.traces[0].column,
            "title": history.title.lower(),
            "unit": history.unit,
            "digits": history.digits,
        }
        for history in timeline.histories
    ]
    return {"quantities": quantities, "regions": _rows(timeline.regions), "phases": _rows(timeline.phases)}


def _rows(bands: Sequence[Band]) -> list[tuple[float, float, str]]:
    return [(band.from_s, band.to_s, printable(band.text)) for band in bands]


def _switches(scene: Scene, *, flown: bool) -> str:
    colours = layer_colours(scene) | ({FLOWN_LABEL: FLOWN} if flown else {})
    boxes = [
        f'<label><input type="checkbox" checked data-layer="{escape(label)}">'
        f'<span class="swatch" style="background:{colour}"></span>{escape(label)}</label>'
        for label, colour in colours.items()
    ]
    return f'<fieldset class="switches"><legend>On the map</legend>{"".join(boxes)}</fieldset>\n'


def _slider(rows: int) -> str:
    return (
        '<p class="slider"><label for="moment">Moment of the flight</label>'
        f'<input type="range" id="moment" min="0" max="{max(rows - 1, 0)}" value="{max(rows - 1, 0)}">'
        '<output for="moment"></output></p>\n'
    )


def _plot(name: str, label: str, words: str) -> str:
    return (
        f'<div class="plot" id="{name}" role="group" aria-label="{label}" aria-describedby="{name}-words"></div>\n'
        f'<p class="small" id="{name}-words">{escape(words)}</p>'
    )


def _json(value: object) -> str:
    """JSON that cannot end the element that it stands in."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
