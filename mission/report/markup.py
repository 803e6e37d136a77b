"""Pieces of a page: text, tables and what is folded away. All text is escaped where it enters."""

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape as escaped

from mission.printable import printable

STYLE = """\
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; color: #111; background: #fff;
  max-width: 60rem; margin: 2rem auto; padding: 0 1.25rem; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .25rem; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid #bbb; padding-bottom: .2rem; }
.verdict { border-left: .5rem solid #595959; background: #f4f4f4; padding: .7rem 1rem; margin: 1.2rem 0; }
.verdict strong { font-size: 1.15rem; }
.achieved { border-color: #009e73; }
.failed { border-color: #d55e00; }
pre, code { font-family: ui-monospace, "DejaVu Sans Mono", Consolas, monospace; font-size: .9rem; }
pre { background: #f4f4f4; padding: .7rem 1rem; overflow-x: auto; white-space: pre-wrap; overflow-wrap: anywhere; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .25rem .8rem .25rem 0; border-bottom: 1px solid #ddd;
  overflow-wrap: anywhere; }
tbody th { font-weight: normal; color: #444; width: 34%; padding-right: 1.2rem; }
.log td:first-child, .log th:first-child { white-space: nowrap; width: 1%; padding-right: 1.2rem; }
.checks td:nth-child(2) { white-space: nowrap; width: 1%; }
.small { font-size: .9rem; color: #333; }
summary { cursor: pointer; padding: .3rem 0; }
figure { margin: 1.6rem 0; break-inside: avoid; }
figure img { max-width: 100%; height: auto; display: block; margin: 0 auto; }
figcaption { color: #333; margin-top: .5rem; }
.switches { border: 0; padding: 0; margin: .6rem 0; display: flex; flex-wrap: wrap; gap: .2rem 1rem; }
.switches legend { float: left; margin-right: 1rem; color: #444; }
.swatch { display: inline-block; width: 1.1rem; height: .5rem; margin: 0 .35rem 0 .25rem; vertical-align: middle;
  print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.plot { min-height: 8rem; }
.slider label { margin-right: .6rem; }
.slider input { width: min(100%, 24rem); vertical-align: middle; }
.slider output { display: block; min-height: 4.5em; font-variant-numeric: tabular-nums; }
.moment { font: inherit; font-variant-numeric: tabular-nums; color: #004b76; background: none; border: 0; padding: 0;
  text-decoration: underline dotted; cursor: pointer; }
:focus-visible { outline: 3px solid #0072b2; outline-offset: 2px; }
@media screen and (min-width: 70rem) {
  #flight:has(section + section) { display: grid; grid-template-columns: 1fr 1fr; gap: 2rem; align-items: start;
    width: min(100vw - 4rem, 100rem); margin-left: calc(50% - min(50vw - 2rem, 50rem)); }
  #flight:has(section + section) section:first-child { position: sticky; top: 0; } }
#flight section { min-width: 0; }
@media (max-width: 30rem) { body { margin: 1rem auto; padding: 0 .6rem; font-size: 15px; }
  tbody th { width: 42%; } th, td { padding-right: .5rem; } }
@media print { body { margin: 0; max-width: none; font-size: 10.5pt; } h2 { break-after: avoid; }
  tr { break-inside: avoid; } .plot { zoom: .74; break-inside: avoid; } .slider, .switches { display: none; }
  .moment { color: inherit; text-decoration: none; } }
"""

Row = tuple[str, str]


class Html(str):
    """Text that is markup already, and must be made of escaped parts."""

    __slots__ = ()


def escape(text: str) -> str:
    """Text for the page: neither markup, nor what would change how the rest reads."""
    return escaped(printable(text, keep="\n\t"))


def details(title: str, text: str) -> str:
    """A text that is folded away under its title."""
    return folded(title, f"<pre>{escape(text)}</pre>")


def facts(rows: Iterable[Row]) -> str:
    """A table of names and values."""
    lines = [f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>' for name, value in rows]
    return "<table><tbody>\n" + "\n".join(lines) + "\n</tbody></table>" if lines else "<p>Nothing is known.</p>"


def folded(title: str, html: str, *, is_open: bool = False) -> str:
    """A piece of a page that is folded away under its title, or can be."""
    return f"<details{' open' * is_open}><summary>{escape(title)}</summary>{html}</details>"


def moment(t_s: float | None) -> Html:
    """A time, to be clicked: map and histories then show it; empty where none is known."""
    if t_s is None or math.isnan(t_s):
        return Html("")
    return Html(f'<button type="button" class="moment" data-time="{t_s:.3f}">{t_s:.2f}</button>')


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, kind: str = "") -> str:
    """A table under a head; ``kind`` is its class."""
    top = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    lines = [
        "<tr>" + "".join(f"<td>{cell if isinstance(cell, Html) else escape(cell)}</td>" for cell in row) + "</tr>"
        for row in rows
    ]
    attribute = f' class="{kind}"' if kind else ""
    return f"<table{attribute}><thead><tr>{top}</tr></thead><tbody>\n" + "\n".join(lines) + "\n</tbody></table>"


def text_of(value: object) -> str:
    """A value of JSON in words."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return " ".join(text_of(part) for part in value)
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {text_of(part)}" for name, part in value.items())
    return "not known" if value is None else str(value)
