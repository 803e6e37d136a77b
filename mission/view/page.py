"""The page itself, before anything is drawn into it."""

import re
from html import escape
from importlib.resources import files
from typing import Final

from mission.plan import FlightPlan
from mission.printable import printable

_PLACE: Final = re.compile(r"\{\{(\w+)\}\}")
_REQUESTS: Final = (
    ("hold", "Hold", "The vehicle slows to rest on its path and waits there."),
    ("resume", "Resume", "A vehicle that waits goes on."),
    (
        "return",
        "Return",
        "A way home is planned and proved from here, and flown; what is left of the mission is given up.",
    ),
    ("land", "Land", "The vehicle lands at once, where it is. The mission is given up."),
)
_FIGURES: Final = (
    ("height", "Height", "m"),
    ("speed", "Speed", "m/s"),
    ("error", "Off its path", "m"),
    ("battery", "Battery", "%"),
    ("left", "Time left", "s"),
)


def page(plan: FlightPlan, shown: str, *, live: bool) -> str:
    """The page of a plan's flight, live with buttons or for looking at again; ``shown`` says what it is."""
    parts = {
        "name": escape(printable(plan.spec.name)),
        "formula": escape(printable(plan.specification)),
        "shown": escape(printable(shown)),
        "live": "yes" if live else "no",
        "figures": "".join(_figure(*each) for each in _FIGURES),
        "buttons": _buttons() if live else "",
    }
    # At once: what is put in is not looked through again.
    return _PLACE.sub(lambda place: parts[place[1]], asset("page.html"))


def asset(name: str) -> str:
    """A file that the page is made of."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _figure(key: str, label: str, unit: str) -> str:
    return f'<div><dt>{label}</dt><dd><span data-value="{key}">–</span> <small>{unit}</small></dd></div>'


def _buttons() -> str:
    buttons = "".join(
        f'<button type="button" data-request="{key}" data-asks="{escape(words)}">{label}</button>'
        for key, label, words in _REQUESTS
    )
    return f'<section id="buttons" aria-label="Commands">{buttons}<p id="answer" role="status"></p></section>'
