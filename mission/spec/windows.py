"""Regions that are where they are for a time only: what a formula means by them, and how that is said."""

import math
from collections.abc import Sequence
from fractions import Fraction

from mission.decimals import decimal
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import (
    LONGEST_S,
    Bounds,
    Formula,
    always,
    negation,
    proposition,
    rebuilt,
)
from mission.spec.model import Region, RegionKind


def window_of(region: Region) -> Bounds | None:
    """From when to when a region is there, by the clock of the trajectory; None where it always is."""
    if region.active_s is None:
        return None
    begin_s, end_s = (Fraction(LONGEST_S) if time == math.inf else Fraction(decimal(time)) for time in region.active_s)
    return begin_s, end_s


def as_there(formula: Formula, regions: Sequence[Region]) -> Formula:
    """A formula of which each proposition is true inside its region while that is there."""
    windows = {region.name: window_of(region) for region in regions if region.active_s is not None}
    if not windows:
        return formula

    def build(node: Formula, operands: tuple[Formula, ...]) -> Formula:
        if node.operator is Operator.PROPOSITION:
            return proposition(node.name, windows.get(node.name))
        return Formula(node.operator, operands, "", node.bounds) if operands else node

    return rebuilt(formula, build)


def kept_out_of(regions: Sequence[Region]) -> tuple[Formula, ...]:
    """What a mission asks for because of the restricted regions that are there for a time only."""
    closing = (each for each in regions if each.kind is RegionKind.RESTRICTED and not each.forbidden)
    return tuple(always(negation(proposition(region.name, window_of(region)))) for region in closing)


def window_text(region: Region) -> str:
    """When a region is there, in words: ``from 60 to 180 s``; empty where it always is."""
    if region.active_s is None:
        return ""
    begin_s, end_s = region.active_s
    if end_s == math.inf:
        return f"from {decimal(begin_s)} s on"
    return f"until {decimal(end_s)} s" if begin_s == 0.0 else f"from {decimal(begin_s)} to {decimal(end_s)} s"
