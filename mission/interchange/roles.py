"""What a feature is for, as far as its properties, its name, its folders and its colour tell."""

import re
from collections.abc import Iterable, Mapping
from typing import Final

from mission.interchange.features import Role

_WORDS: Final = {
    Role.RESTRICTED: (
        "restricted|restriction|forbidden|prohibited|no ?fly|nfz|no ?go|keep ?out|exclude|exclusion|excluded|avoid|"
        "obstacle|hazard|danger"
    ),
    Role.BOUNDARY: (
        "boundary|bounds|border|fence|geo ?fence|perimeter|limit|inclusion|include|flight area|flying area|"
        "operating area|operation area|operational area|flight zone|domain"
    ),
    Role.SURVEY: "survey|mapping|photo|photograph|scan|inspect|inspection|roi|aoi|target",
}
"""Words for what is to be done, or not to be done, with something: they come before what it is."""

_THINGS: Final = {
    Role.RESTRICTED: (
        "hole|hospital|school|building|(?:farm|glass|green|ware|boat|power )?house|barn|shed|"
        "silo|stable|greenhouse|substation|pylon|mast|power ?line|power|cable|line_?power|road|street|highway|motorway|"
        "railway|rail|track bed|pond|lake|river|creek|canal|stream|waterway|water"
    ),
    Role.HOME: "home|home ?base|launch|launch ?pad|landing|landing ?pad|take ?off|pad|helipad|rally|base|start",
    Role.SURVEY: ("field|plot|parcel|block|crop|farmland|meadow|paddock|pasture|orchard|vineyard|acre|solar|row"),
    Role.AREA: "^area$|lawn|garden|grass",
}
_PATTERNS: Final = [
    (role, re.compile(rf"(?<![a-z])(?:{words})(?:e?s)?(?![a-z])"))
    for told in (_WORDS, _THINGS)
    for role, words in told.items()
]
_SPEAKING_KEYS: Final = re.compile(
    "kind|type|class|category|role|zone|usage|use|fence|fclass|landuse|natural|leisure|building|power|highway|railway|"
    "waterway|water|amenity",
    re.IGNORECASE,
)
_TRUE: Final = frozenset({"yes", "true", "1"})
_FALSE: Final = frozenset({"no", "false", "0", "none", "null", ""})


def role_of(
    properties: Mapping[str, str], name: str, folders: Iterable[str], style: str = "", fill: str = ""
) -> tuple[Role | None, str]:
    """The role of a feature and what tells it, None where nothing does.

    Args:
        properties: Of the feature, as text.
        name: Of the feature.
        folders: It lies in, from the outermost; layers and documents count, too.
        style: Name of its style.
        fill: Colour that it is filled with, ``rrggbb``.
    """
    for key, value in properties.items():
        if key.lower() == "inclusion" and value.lower() in _TRUE | _FALSE:
            return (Role.BOUNDARY if value.lower() in _TRUE else Role.RESTRICTED), f"told by its property {key}"
        if _SPEAKING_KEYS.fullmatch(key) and value.lower() not in _FALSE:
            role = _in_words(key if value.lower() in _TRUE else value) or _in_words(f"{key} {value}")
            if role:
                return role, f"told by its property {key}"
    texts = [
        (name, "told by its name"),
        *((folder, "told by its folder") for folder in reversed(list(folders))),
        (style, "told by its style"),
    ]
    for text, told_by in texts:
        role = _in_words(text)
        if role:
            return role, told_by
    return (Role.RESTRICTED, "told by its red fill") if _is_red(fill) else (None, "")


def _in_words(text: str) -> Role | None:
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text)
    words = re.sub(r"[\W_]+", " ", apart).lower()
    return next((role for role, pattern in _PATTERNS if pattern.search(words)), None)


def _is_red(fill: str) -> bool:
    if not re.fullmatch("[0-9a-fA-F]{6}", fill):
        return False
    red, green, blue = (int(fill[i : i + 2], 16) for i in (0, 2, 4))
    return red >= 0xC0 and max(green, blue) <= 0x60  # noqa: PLR2004 - what people call red
