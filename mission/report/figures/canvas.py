"""From an empty figure to the bytes of a file, with no state that outlives a call and no window system."""

import io
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Final

from matplotlib import rc_context, style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ft2font import FT2Font
from matplotlib.textpath import text_to_path

from mission.plan import FlightPlan
from mission.printable import shows
from mission.report.palette import BLACK, QUIET, STYLE

DPI = 150
POINTS_PER_INCH = 72.0
LINE_HEIGHT_EM = 1.17
TITLE_PT, NOTE_PT, NOTE_LINE_PT = 12.5, 9.0, 11.0
LEAST_PT = 8.0
"""The least size of a text: what would have to be smaller is left out, and the picture says so."""
SIDE_PT, TITLE_LINE_PT, ABOUT_LINE_PT, MOST_ABOUT_LINES = 12.0, 26.0, 12.0, 2


@contextmanager
def drawing() -> Iterator[None]:
    """The project's style inside, whatever the user's matplotlibrc says; the caller's again after it."""
    with style.context(["default", STYLE]):
        yield


def new_figure(width_pt: float, height_pt: float) -> Figure:
    """An empty white figure on the Agg canvas, sizes in points."""
    figure = Figure(figsize=(width_pt / POINTS_PER_INCH, height_pt / POINTS_PER_INCH), dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def about(plan: FlightPlan, width_pt: float) -> str:
    """The mission's name and what it asks for, in at most two lines that fit a picture of this width."""
    asked = ", ".join(text for _, text in plan.written)
    words = plain(" ".join(f"{plan.spec.name}: {asked}".split()))
    return abridged(words, (width_pt - 2 * SIDE_PT) / NOTE_PT, MOST_ABOUT_LINES)


def head_pt(about_it: str) -> float:
    """Height of what stands at the top of a picture: its title, and the lines about its mission."""
    return TITLE_LINE_PT + ABOUT_LINE_PT * (about_it.count("\n") + 1 if about_it else 0)


def titled(figure: Figure, title: str, note: str = "", about_it: str = "") -> None:
    """Put what the picture shows at its top left, over its mission, and a small note under it at the bottom."""
    height_pt = figure.get_figheight() * POINTS_PER_INCH
    left = SIDE_PT / (figure.get_figwidth() * POINTS_PER_INCH)
    figure.text(left, 1 - 8 / height_pt, plain(title), fontsize=TITLE_PT, fontweight="bold", color=BLACK, va="top")
    if about_it:
        top = 1 - TITLE_LINE_PT / height_pt
        figure.text(left, top, about_it, fontsize=NOTE_PT, color=QUIET, va="top", gid="about")
    if note:
        figure.text(left, 7 / height_pt, plain(note), fontsize=NOTE_PT, color=QUIET, va="bottom")


def to_png(figure: Figure) -> bytes:
    """The figure as PNG; the same bytes for the same figure, as no date or version is written."""
    stream = io.BytesIO()
    with drawing():
        figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": None}, pil_kwargs={"compress_level": 3})
    return stream.getvalue()


def to_svg(figure: Figure) -> bytes:
    """The figure as SVG, its text as outlines; the same bytes for the same figure."""
    stream = io.BytesIO()
    with drawing(), rc_context({"svg.hashsalt": "figure"}):
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def to_pdf(figure: Figure) -> bytes:
    """The figure as PDF; the same bytes for the same figure."""
    stream = io.BytesIO()
    with drawing():
        figure.savefig(stream, format="pdf", metadata={"CreationDate": None, "Creator": None, "Producer": None})
    return stream.getvalue()


WRITERS: Final[Mapping[str, Callable[[Figure], bytes]]] = {"png": to_png, "svg": to_svg, "pdf": to_pdf}
"""The formats of pictures, by the endings of their files."""


def plain(text: str) -> str:
    """The text with a replacement for every character that the font cannot draw."""
    return "".join(character if character == "\n" or _drawable(character) else "\ufffd" for character in text)


@cache
def _drawable(character: str) -> bool:
    return shows(character) and _font().get_char_index(ord(character)) != 0


@cache
def _font() -> FT2Font:
    return get_font(findfont(FontProperties(family="DejaVu Sans")))


@cache
def _width_em(line: str, weight: str) -> float:
    width, _, _ = text_to_path.get_text_width_height_descent(
        line, FontProperties(family="DejaVu Sans", size=100, weight=weight), ismath=False
    )
    return float(width) / 100


def text_size_em(text: str, weight: str = "normal") -> tuple[float, float]:
    """Width and height of a text of one or more lines, in units of its font size."""
    lines = text.split("\n")
    return max(_width_em(line, weight) for line in lines), LINE_HEIGHT_EM * len(lines)


def in_width(text: str, most_em: float) -> str:
    """The text with line breaks between words, so that no line of several words is wider, in units of its font size."""
    lines: list[str] = []
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_size_em(longer)[0] <= most_em:
            lines[-1] = longer
        else:
            lines.append(word)
    return "\n".join(lines)


def abridged(text: str, most_em: float, most_lines: int) -> str:
    """The text in at most so many lines of at most this width; what has no room is cut off and an ellipsis says so."""
    lines = in_width(text, most_em).split("\n")
    kept = lines[:most_lines]
    for k, line in enumerate(kept):
        cut = len(lines) > most_lines and k == most_lines - 1
        if cut or text_size_em(line)[0] > most_em:
            kept[k] = _cut(line, most_em)
    return "\n".join(kept)


def _cut(line: str, most_em: float) -> str:
    """The longest beginning of a line that has room before an ellipsis."""
    begins = range(1, len(line) + 1)
    end = bisect_right(begins, most_em, key=lambda end: text_size_em(f"{line[:end]} …")[0])
    return f"{line[:end].rstrip()} …"
