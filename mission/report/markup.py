"""Pieces of a page: text, tables and what is folded away. All text is escaped where it enters."""

from collections.abc import Iterable, Sequence
from html import escape as escaped

from mission.printable import printable

STYLE = """\
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; color: #111; background: #fff;
  max-width: 60rem; margin: 2rem auto; padding: 0 1.25rem; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .25rem; }
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
.log td:nth-child(-n+2), .log th { white-space: nowrap; width: 1%; padding-right: 1.2rem; }
summary { cursor: pointer; padding: .3rem 0; }
figure { margin: 1.6rem 0; break-inside: avoid; }
figure img { max-width: 100%; height: auto; display: block; margin: 0 auto; }
figcaption { color: #333; margin-top: .5rem; }
@media print { body { margin: 0; max-width: none; font-size: 11pt; } h2 { break-after: avoid; }
  tr { break-inside: avoid; } }
"""

Row = tuple[str, str]


def escape(text: str) -> str:
    """Text for the page: neither markup, nor what would change how the rest reads."""
    return escaped(printable(text, keep="\n\t"))


def details(title: str, text: str) -> str:
    """A text that is folded away under its title."""
    return f"<details><summary>{escape(title)}</summary><pre>{escape(text)}</pre></details>"


def facts(rows: Iterable[Row]) -> str:
    """A table of names and values."""
    lines = [f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>' for name, value in rows]
    return "<table><tbody>\n" + "\n".join(lines) + "\n</tbody></table>" if lines else "<p>Nothing is known.</p>"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, kind: str = "") -> str:
    """A table under a head; ``kind`` is its class."""
    top = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    lines = ["<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows]
    attribute = f' class="{kind}"' if kind else ""
    return f"<table{attribute}><thead><tr>{top}</tr></thead><tbody>\n" + "\n".join(lines) + "\n</tbody></table>"
