"""Whether a plan that was written is what its mission plans to: the two documents, place by place."""

import math
from typing import Any, Final

_SAME: Final = 1e-6
"""Numbers that differ by less, absolutely or relatively, are alike: other machines round otherwise."""
_SHOWN: Final = 60


def difference(written: Any, due: Any, place: str = "") -> str | None:  # noqa: ANN401 - any JSON value
    """Say where two JSON documents first differ, and how; None where they are alike.

    Args:
        written: The document in question.
        due: What it should be.
        place: Where both stand in a larger document, for the sentence.
    """
    if isinstance(written, dict) and isinstance(due, dict):
        odd = next(iter(sorted(written.keys() ^ due.keys())), None)
        if odd is not None:
            return f"`{_inner(place, odd)}` {'does not belong there' if odd in written else 'is missing'}"
        pairs = [(_inner(place, key), written[key], due[key]) for key in due]
    elif isinstance(written, list) and isinstance(due, list):
        if len(written) != len(due):
            return f"`{place}` has {len(written)} entries, and its mission plans {len(due)}"
        pairs = [(_inner(place, number), *both) for number, both in enumerate(zip(written, due, strict=True))]
    else:
        return None if _alike(written, due) else f"`{place}` is {_shown(written)}, and its mission plans {_shown(due)}"
    return next((found for found in (difference(a, b, inner) for inner, a, b in pairs) if found), None)


def _inner(place: str, key: object) -> str:
    return f"{place}.{key}" if place else str(key)


def _alike(written: Any, due: Any) -> bool:  # noqa: ANN401 - any JSON value
    if isinstance(written, float) or isinstance(due, float):
        numbers = isinstance(written, int | float) and isinstance(due, int | float)
        return numbers and not isinstance(written, bool) and math.isclose(written, due, rel_tol=_SAME, abs_tol=_SAME)
    return type(written) is type(due) and written == due


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."
