"""The pictures of a flight, counted."""

from collections.abc import Sequence


def missing(numbers: Sequence[int]) -> int:
    """How many pictures were taken that nothing was heard of, by the numbers of those between which they lie."""
    return max(max(numbers) - min(numbers) + 1 - len(set(numbers)), 0) if numbers else 0


def pictures_text(numbers: Sequence[int], planned: int, trouble: str = "") -> str:
    """What became of the photographs in plain words; empty where none were planned or taken.

    Args:
        numbers: Of the pictures that were told of.
        planned: How many there should be.
        trouble: What went wrong with the camera, in plain words.
    """
    if not (numbers or planned):
        return trouble
    count = len(numbers)
    taken = f"{count} photograph{'s' if count != 1 else ''} of {planned} planned"
    lost = missing(numbers)
    unheard = f"nothing was heard of {lost} more" if lost else ""
    return ", ".join(filter(None, (taken, unheard, trouble)))
