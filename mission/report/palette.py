"""One palette for every picture: Okabe and Ito's, which no kind of colour blindness merges.

Colour never carries a meaning alone: restricted regions are hatched, regions are named, the planned path is thin, the
flown one strong. Clearances end at dashes, outlines are drawn through.
"""

from mission.spec.model import RegionKind

BLACK = "#000000"
ORANGE = "#E69F00"
SKY_BLUE = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
WHITE = "#FFFFFF"
OKABE_ITO = (BLACK, ORANGE, SKY_BLUE, GREEN, YELLOW, BLUE, VERMILLION, PURPLE)

MESH = "#BDBDBD"  # edges of triangles, behind all else
QUIET = "#595959"  # small print; 7:1 on white

PLANNED = BLACK
LOOP = PURPLE
SMOOTHED = BLUE
FLOWN = BLUE
TUBE = YELLOW
EAST = BLUE
NORTH = VERMILLION

KIND_COLOUR = {
    RegionKind.SURVEY: SKY_BLUE,
    RegionKind.RESTRICTED: VERMILLION,
    RegionKind.HOME: GREEN,
    RegionKind.AREA: ORANGE,
}
FILL_ALPHA = {RegionKind.SURVEY: 0.38, RegionKind.RESTRICTED: 0.16, RegionKind.HOME: 0.34, RegionKind.AREA: 0.22}
MARGIN_ALPHA = 0.12
MARGIN_DASHES = (0.0, (5.0, 3.0))
HATCH = "////"

STYLE = {
    "font.family": ["DejaVu Sans"],  # comes with matplotlib: the same picture everywhere
    "text.parse_math": False,  # names come from files
    "font.size": 10.5,
    "axes.labelsize": 10.5,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.labelsize": 9.5,
    "ytick.labelsize": 9.5,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "hatch.color": VERMILLION,
    "hatch.linewidth": 1.3,
    "lines.solid_capstyle": "round",
    "lines.solid_joinstyle": "round",
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "path.simplify_threshold": 0.2,
    "agg.path.chunksize": 20_000,
}
