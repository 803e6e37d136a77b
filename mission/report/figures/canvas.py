"""From an empty figure to the bytes of a file, with no state that outlives a call and no window system."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from matplotlib import rc_context, style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ft2font import FT2Font
from matplotlib.textpath import text_to_path

from mission.printable import shows
from mission.report.palette import BLACK, QUIET, STYLE

DPI = 150
POINTS_PER_INCH = 72.0
LINE_HEIGHT_EM = 1.17
TITLE_PT, NOTE_PT = 12.5, 9.0


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


def titled(figure: Figure, title: str, note: str = "") -> None:
    """Put what the picture shows at its top left, and a small note under it at the bottom."""
    height_pt = figure.get_figheight() * POINTS_PER_INCH
    left = 12.0 / (figure.get_figwidth() * POINTS_PER_INCH)
    figure.text(left, 1 - 8 / height_pt, plain(title), fontsize=TITLE_PT, fontweight="bold", color=BLACK, va="top")
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
