"""The modes and what leads from one to another, drawn from the tables of `modes`: a table, for Graphviz, for Mermaid.

A pilot may ask for any mode; modes that need a position are refused without one. That is said once, not drawn. A
failsafe's action enters the first of its modes that the estimator allows; the ways to the others are dashed.
"""

from collections.abc import Iterator
from enum import Enum
from typing import Final, NamedTuple

from vehicle_sim.autopilot.modes import FAILSAFE_MODES, FIRST_MODE, MODES, TRANSITIONS, Mode
from vehicle_sim.parameters import Flavour

_ON: Final = "power on"
_FAILURE: Final = "failsafe"
_TEXT: Final = "any mode by request of the pilot; filled modes need a position"
_FILL: Final = "#56B4E9"
_FAILURE_FILL: Final = "#E69F00"


class Drawing(Enum):
    """The form in which the modes are shown."""

    TABLE = "table"
    DOT = "dot"
    MERMAID = "mermaid"


class Edge(NamedTuple):
    """One way from mode to mode: `source` is None for a failsafe's action in whatever mode it comes."""

    source: Mode | None
    target: Mode
    label: str
    is_fallback: bool


def edges(flavour: Flavour) -> Iterator[Edge]:
    """Return all ways that the tables hold: events first, then the actions of failsafes by preference."""
    for (source, event), target in TRANSITIONS[flavour].items():
        yield Edge(source, target, _words(event.name), is_fallback=False)
    for action, choices in FAILSAFE_MODES[flavour].items():
        for place, target in enumerate(choices):
            yield Edge(None, target, _words(action.name), is_fallback=place > 0)


def drawing(flavour: Flavour, form: Drawing) -> str:
    """Return the modes of `flavour` as text."""
    return {Drawing.TABLE: _table, Drawing.DOT: _dot, Drawing.MERMAID: _mermaid}[form](flavour)


def _words(name: str) -> str:
    return name.lower().replace("_", " ")


def _table(flavour: Flavour) -> str:
    rows = [("mode", "position", "arming", "then", "failsafe actions that end here")]
    for mode, rule in MODES[flavour].items():
        ways = [edge for edge in edges(flavour) if edge.source is mode]
        ends = [edge for edge in edges(flavour) if edge.source is None and edge.target is mode]
        then = ", ".join(f"{way.label}: {MODES[flavour][way.target].name}" for way in ways)
        actions = ", ".join(f"({end.label})" if end.is_fallback else end.label for end in ends)
        first = " *" if mode is FIRST_MODE[flavour] else ""
        needs, arms = "needed" if rule.needs_position else "-", "yes" if rule.armable else "no"
        rows.append((rule.name + first, needs, arms, then or "-", actions or "-"))
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    lines.insert(1, "  ".join("-" * width for width in widths))
    return "\n".join([*lines, "", "* after boot; (action) only where its first mode is not possible"]) + "\n"


def _dot(flavour: Flavour) -> str:
    names = MODES[flavour]
    lines = [
        f'digraph "{flavour.value}" {{',
        "  rankdir=LR; nodesep=0.35; ranksep=1.1;",
        f'  label="{_TEXT}"; fontname=Helvetica;',
        '  node [shape=box, style="rounded", fontname=Helvetica]; edge [fontname=Helvetica, fontsize=11];',
        f'  "{_ON}" [shape=plaintext];',
        f'  "{_FAILURE}" [style="rounded,filled", fillcolor="{_FAILURE_FILL}"];',
    ]
    for rule in names.values():
        look = f' [style="rounded,filled", fillcolor="{_FILL}"]' if rule.needs_position else ""
        lines.append(f'  "{rule.name}"{look};')
    lines.append(f'  "{_ON}" -> "{names[FIRST_MODE[flavour]].name}";')
    for edge in edges(flavour):
        source = _FAILURE if edge.source is None else names[edge.source].name
        dashes = ", style=dashed" if edge.is_fallback else ""
        lines.append(f'  "{source}" -> "{names[edge.target].name}" [label="{edge.label}"{dashes}];')
    return "\n".join([*lines, "}"]) + "\n"


def _mermaid(flavour: Flavour) -> str:
    names = MODES[flavour]
    lines = ["flowchart LR", f"  on([{_ON}]) --> {FIRST_MODE[flavour].name}", f"  failsafe([{_FAILURE}])"]
    lines += [f'  {mode.name}["{rule.name}"]' for mode, rule in names.items()]
    for edge in edges(flavour):
        source = "failsafe" if edge.source is None else edge.source.name
        arrow = f"-. {edge.label} .->" if edge.is_fallback else f"-- {edge.label} -->"
        lines.append(f"  {source} {arrow} {edge.target.name}")
    needing = ",".join(mode.name for mode, rule in names.items() if rule.needs_position)
    return "\n".join([*lines, f"  classDef position fill:{_FILL}", f"  class {needing} position"]) + "\n"
