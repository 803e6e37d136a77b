"""Crossing points on a mission's map, with room for the tube, without, or on its own mesh."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np

from mission.errors import GeometryError
from mission.geometry.arrays import BoolArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.outline_mesh import JOINED, ClassedMesh, Outlines
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import selected
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD
from mission.plan.costs import UNIT
from mission.planning.crossings import Crossings, Spacing, crossings
from mission.spec.model import Cost, MissionSpec, Point

_LARGEST: Final = 0.1  # of the extent: the longest edge of the mesh
_SPACINGS: Final = ((0.015, 1, 5), (0.02, 1, 3), (0.03, 1, 2), (0.03, 1, 1), (0.03, 0, 1))
"""Distances of crossing points, of the extent, and how many there are on an edge: the finer, the better."""
_MOST_MESHES: Final = 4
_OUTLINE_MESHES: Final[WeakKeyDictionary[Partition, dict[tuple[bytes, bytes, float], ClassedMesh]]] = (
    WeakKeyDictionary()
)
"""Of each map the meshes that were made of it last."""
_MOST_WAYS: Final = 4_000_000
"""Ways times copies of the map that a search may take; the finest spacing that does is used."""


@dataclass(frozen=True, eq=False)
class CrossingMaps:
    """The crossing points of one mission.

    Attributes:
        spec: The mission.
        labelling: The labels of its triangles.
        restricted: Shape (M,), triangles that must not be entered.
        locator: Finds triangles.
        start_m: Where the flight begins.
        triangle: The triangle there.
    """

    spec: MissionSpec
    labelling: Labelling
    restricted: BoolArray
    locator: Locator
    start_m: Point
    triangle: int

    def each(self, automaton: Conjunction, unfit: frozenset[int] = frozenset()) -> Iterator[Crossings]:
        """Crossing points with room for the tube, without, and on the mission's own mesh, as far as there are any.

        They are made when they are first asked for.

        Args:
            automaton: What is searched with. What it never reads is kept out of like what is restricted.
            unfit: Letters that are kept out of as well.
        """
        blocked = self._blocked(automaton, unfit)
        for room, own in ((True, False), (False, False), (False, True)):
            key = (room, own, blocked.tobytes())
            if key not in self._made:
                self._made[key] = self._crossings(blocked, room=room, own=own, copies=_copies(automaton))
            made = self._made[key]
            if made is not None:
                yield made

    def foresee(self, automaton: Conjunction) -> None:
        """Make the mesh that serves wherever the flight begins."""
        with suppress(GeometryError):  # which whoever asks for crossing points goes without
            self._outline_mesh(self._blocked(automaton, frozenset()), self.spec.flight.tube_m)

    def _blocked(self, automaton: Conjunction, unfit: frozenset[int]) -> BoolArray:
        never = (automaton.whole.targets == DEAD).all(axis=0)
        never[list(unfit)] = True
        never[self.labelling.letter_of[self.triangle]] = False
        blocked: BoolArray = self.restricted | never[self.labelling.letter_of]
        return blocked

    @property
    def near_m(self) -> float:
        """How far ways may be off the outlines of the mission."""
        return JOINED * self._partition.extent_m

    @property
    def _partition(self) -> Partition:
        return self.locator.partition

    @cached_property
    def _made(self) -> dict[tuple[bool, bool, bytes], Crossings | None]:
        return {}

    def _crossings(self, blocked: BoolArray, *, room: bool, own: bool, copies: int) -> Crossings | None:
        clearance_m = self.spec.flight.tube_m if room else 0.0
        if room and clearance_m == 0.0:
            return None
        try:
            mesh = self._own_mesh(~blocked) if own else self._outline_mesh(blocked, clearance_m)
        except GeometryError:
            return None
        touching = Locator(mesh.partition).triangles_touching(self.start_m)
        beginnings = touching[mesh.class_of[touching] == self.labelling.letter_of[self.triangle]]
        if not len(beginnings):
            return None
        return crossings(
            mesh.partition,
            mesh.class_of,
            self.labelling.letters,
            beginnings=beginnings,
            start_m=self.start_m,
            spacing=self._spacing(mesh.partition, copies),
            unit_m=self._unit_m,
            tolls=self._tolls,
        )

    def _spacing(self, mesh: Partition, copies: int) -> Spacing:
        spacings = [Spacing(share * self._partition.extent_m, *counts) for share, *counts in _SPACINGS]
        return next((one for one in spacings if one.ways(mesh) * copies <= _MOST_WAYS), spacings[-1])

    def _outline_mesh(self, blocked: BoolArray, clearance_m: float) -> ClassedMesh:
        """The mesh of the outlines, which is remembered with the triangles: it does not depend on the start."""
        made = _OUTLINE_MESHES.setdefault(self._partition, {})
        letter_of = self.labelling.letter_of
        key = (letter_of.tobytes(), blocked.tobytes(), clearance_m)
        if key not in made:
            mesh = Outlines.of(self.locator, letter_of, blocked).mesh(clearance_m, largest_share=_LARGEST)
            if len(made) >= _MOST_MESHES:
                del made[next(iter(made))]
            made[key] = mesh
        return made[key]

    def _own_mesh(self, kept: BoolArray) -> ClassedMesh:
        mesh = self._partition
        open_mesh = selected(mesh.vertices_m, mesh.triangles, mesh.neighbours, kept)
        return ClassedMesh(open_mesh, self.labelling.letter_of[kept])

    @property
    def _unit_m(self) -> float:
        """The length that weighs 1."""
        unit = UNIT[self.spec.search.cost][1]
        return unit * self.spec.flight.speed_m_s if self.spec.search.cost is Cost.TIME else unit

    @cached_property
    def _tolls(self) -> IntArray:
        """What it costs to come from one letter to another, shape (letters, letters): stops, where time counts."""
        letters = self.labelling.letters
        tolls = np.ones((len(letters), len(letters)))
        if self.spec.search.cost is Cost.TIME:
            halt_s = self.spec.flight.speed_m_s / self.spec.limits.acceleration_m_s2
            for region in self.spec.regions:
                inside = np.array([region.name in letter for letter in letters])
                if region.loiter_s > 0.0:
                    tolls += (~inside[:, None] & inside) * (region.loiter_s + halt_s) / UNIT[Cost.TIME][1]
        return np.rint(tolls).astype(np.int64)


def _copies(automaton: Conjunction) -> int:
    """How many times as large as its map a search is: in tours, what was met counts (``mission.planning.tours``)."""
    met = max((inf.bit_count() for _, inf in automaton.whole.pairs), default=0)
    return automaton.size << met if met > 1 else automaton.size
