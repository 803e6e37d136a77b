"""A proof that a curve, inflated by a tube, satisfies a formula and keeps off what is restricted.

It is a proof by bounds, not by samples. The claim is about every vehicle whose position stays within ``tube_m`` of
r(s) on each axis, in whatever way it moves there, while s runs from 0 to T without ever going back (at any speed, with
any stops): that

1. it never leaves the domain and never meets a restricted triangle, border included;
2. every word over the labels of triangles that it can spell satisfies the formula (``possible_words`` says exactly
   what a word is, and how it goes on for ever after the end of the curve: staying there, or flying the last leg of the
   curve, a lap, again and again).

Of a flight that stays it is also about its landing, in which the vehicle may be ``landing_m`` farther from the end.

The curve is enclosed piece by piece (``enclosure``), which gives for each piece the triangles that the tube may touch.
Where the claim fails, the pieces that are to blame are cut and it is tried again, until the pieces are short against
the tube: what is then not proved is reported with its place and its reason, and is not flown.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import CompiledAutomaton
from mission.spec.clearances import largest_m
from mission.spec.model import Semantics
from mission.steering.certificate import Certificate
from mission.steering.enclosure import (
    Contacts,
    Enclosure,
    enclose,
    insert_knots,
    split,
)
from mission.steering.explanation import Explanation, Lap, explain, place, point
from mission.steering.joined import JoinedCurve, joins
from mission.steering.possible_words import Layers, Violations
from mission.steering.touched import StillTouched, Touched

_CELLS_PER_WAVE = 8
_FEWEST_CELLS = 128
_PARTS = 4  # what a piece is cut into
_ROUNDS = 12
_SHARPENINGS = 3
_FINEST_PART_OF_TUBE = 0.25
_FINEST_PART_OF_EXTENT = 2e-5


@dataclass(frozen=True, eq=False)
class _Doubt:
    """What is not proved yet.

    Attributes:
        blame: Shape (K,), the pieces that are to blame.
        certain: Indices of knots at which the tube certainly leaves the domain or meets something restricted.
        violations: The violating words; None where the tube is not even known to be safe.
        layers_from: For each layer of the words, the first index of its contacts.
    """

    blame: BoolArray
    certain: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    violations: Violations | None = None
    layers_from: tuple[int, ...] = ()


@dataclass(frozen=True)
class _Ways:
    """How a flight begins and goes on: where its lap begins, if it has one, and ``begins`` of ``Prover.certify``."""

    lap_from_s: float | None
    begins: Mapping[int, int] | None


class Prover:
    """Certifies curves of one mission; what depends on the partition alone is built once.

    Args:
        partition: The domain.
        labelling: Its labels.
        refutation: The automaton of the negated formula over ``labelling.letters``.
        semantics: Whether a word begins with the label of the start triangle.
        restricted: Shape (M,), the triangles that the tube must never meet.
        tube_m: Half width of the tube on each axis, at least 0.
        landing_m: How far a landing may drift from where the vehicle is in the tube.
        touched: What the tube touches of a domain that moves, along the one curve whose timing it knows.
    """

    def __init__(
        self,
        partition: Partition,
        labelling: Labelling,
        *,
        refutation: CompiledAutomaton,
        semantics: Semantics,
        restricted: BoolArray,
        tube_m: float,
        landing_m: float = 0.0,
        touched: Touched | None = None,
    ) -> None:
        if not (np.isfinite(tube_m) and tube_m >= 0.0):
            raise ValueError("the half width of a tube is a finite length, at least 0")
        self._partition, self._labelling = partition, labelling
        self._refutation, self._semantics = refutation, semantics
        self._restricted = restricted
        self._tube_m, self._landing_m = float(tube_m), landing_m
        self._touched = touched or StillTouched(partition, restricted, self._tube_m)
        extent = float(np.ptp(partition.vertices_m, axis=0).max())
        self._finest_m = max(_FINEST_PART_OF_TUBE * self._tube_m, _FINEST_PART_OF_EXTENT * extent)

    def certify(
        self, curve: JoinedCurve, *, repeats: bool = False, begins: Mapping[int, int] | None = None
    ) -> Certificate:
        """Prove the claim of a curve, or say where it fails.

        Args:
            curve: The smoothed path.
            repeats: Whether its last leg is a lap that is flown for ever; otherwise the flight stays at the end.
            begins: Of a flight that goes on from another one, the states of the refutation (bits) that are possible in
                each triangle in which it begins, as from ``reached``; by default a word begins here.

        Raises:
            ValueError: The lap does not end where it begins.
        """
        if repeats and not joins(curve.legs[-1], curve.legs[-1]):
            raise ValueError("a lap ends where it begins")
        ways = _Ways(float(curve.starts_s[-2]) if repeats else None, begins)
        enclosure = enclose(curve, max(_FEWEST_CELLS, _CELLS_PER_WAVE * curve.frequencies))
        contacts = self._touched.pieces(enclosure)
        doubt = self._doubt(enclosure, contacts, ways)
        for _ in range(_ROUNDS):
            if doubt is None or len(doubt.certain):
                break
            coarse = doubt.blame & (enclosure.reach_m > self._finest_m)
            if not coarse.any():
                break
            enclosure = split(curve, enclosure, coarse, _PARTS)
            contacts = self._touched.pieces(enclosure)
            doubt = self._doubt(enclosure, contacts, ways)
        if doubt is None:
            enclosure, contacts = self._sharpened(curve, enclosure, contacts)
            landing_m = 0.0 if repeats else self._landing(enclosure, contacts, ways)
            return replace(self._proved(curve, enclosure, contacts), landing_m=landing_m)
        certificate = self._proved(curve, enclosure, contacts)
        if doubt.violations is None:
            told = self._unsafe_place(enclosure, contacts, doubt)
        else:
            told = self._violating_flight(enclosure, contacts, doubt.violations, doubt.layers_from, ways.lap_from_s)
        return replace(
            certificate,
            holds=False,
            reason=told.reason,
            where_s=told.where_s,
            where_m=told.where_m,
            counterexample=told.triangles,
        )

    def reached(self, curve: JoinedCurve, certificate: Certificate) -> dict[int, int]:
        """What the words may have led to when a flight ends after any number of laps, at least one.

        Args:
            curve: Its last leg is the lap.
            certificate: Of the curve, by any prover of this domain and tube; its pieces are used.

        Returns:
            For each triangle that the tube may touch at the end, the states of the refutation as bits.
        """
        grid = enclose(curve, max(_FEWEST_CELLS, _CELLS_PER_WAVE * curve.frequencies))
        enclosure = insert_knots(curve, grid, certificate.knots_s)
        sets = self._touched.pieces(enclosure).sets
        layers, _ = self._layers(enclosure.knots_s, sets, float(curve.starts_s[-2]))
        return self._violations(layers, None).at_end()

    def _landing(self, enclosure: Enclosure, contacts: Contacts, ways: _Ways) -> float:
        """How far from the tube at the end a landing may drift, at most as far as it is said to."""
        layers, _ = self._layers(enclosure.knots_s, contacts.sets, None)
        at_end = self._violations(layers, ways.begins).at_end()

        def holds(drift_m: float) -> bool:
            there = self._touched.end(enclosure, self._tube_m + drift_m)
            if (there.outside | there.marked(self._restricted)).any():
                return False
            return not self._violations(Layers((there.sets[0],), None), at_end).exists()

        return self._landing_m if holds(self._landing_m) else largest_m(holds, self._landing_m) or 0.0

    def _sharpened(self, curve: JoinedCurve, enclosure: Enclosure, contacts: Contacts) -> tuple[Enclosure, Contacts]:
        """The pieces at the borders of regions cut further, so that what the tube surely spells shows."""
        for _ in range(_SHARPENINGS):
            mixed = self._letters(contacts) > 1
            coarse = mixed & (enclosure.reach_m > max(self._tube_m, self._finest_m))
            if coarse.any():
                enclosure = split(curve, enclosure, coarse, _PARTS)
                contacts = self._touched.pieces(enclosure)
        return enclosure, contacts

    def _letters(self, contacts: Contacts) -> IntArray:
        """How many different letters the triangles of each piece have, shape (K,)."""
        return np.bincount(self._letters_of(contacts)[0], minlength=len(contacts.outside))[1:-1]

    def _letters_of(self, contacts: Contacts) -> tuple[IntArray, IntArray]:
        """Of each piece the letters of its triangles: pieces, ascending, and one letter of each, shape (L,) both."""
        count = len(self._labelling.letters)
        return np.divmod(np.unique(contacts.pieces * count + self._labelling.letter_of[contacts.triangles]), count)

    def _doubt(self, enclosure: Enclosure, contacts: Contacts, ways: _Ways) -> _Doubt | None:
        """What cannot be proved with these pieces; None where all can."""
        unsafe = (contacts.outside | contacts.marked(self._restricted))[1:-1]
        if unsafe.any():
            at_knots = self._touched.knots(enclosure)
            certain = np.flatnonzero(at_knots.outside | at_knots.marked(self._restricted))
            return _Doubt(unsafe, certain)
        layers, first = self._layers(enclosure.knots_s, contacts.sets, ways.lap_from_s)
        violations = self._violations(layers, ways.begins)
        return self._wordy_doubt(enclosure, contacts, violations, first) if violations.exists() else None

    def _layers(
        self, knots_s: FloatArray, sets: Sequence[tuple[int, ...]], lap_from_s: float | None
    ) -> tuple[Layers, tuple[int, ...]]:
        """The layers of K + 2 sets of triangles, and the first set of each."""
        loop = None if lap_from_s is None else int(np.searchsorted(knots_s, lap_from_s)) + 1
        # Equal layers in a row are one; the head of the loop begins a new one.
        first = tuple(i for i in range(len(sets)) if i in (0, loop) or sets[i] != sets[i - 1])
        return Layers(tuple(sets[i] for i in first), None if loop is None else first.index(loop)), first

    def _violations(self, layers: Layers, begins: Mapping[int, int] | None) -> Violations:
        return Violations(
            layers,
            corners=self._partition.triangles,
            letter_of=self._labelling.letter_of,
            refutation=self._refutation,
            semantics=self._semantics,
            begins=begins,
        )

    def _wordy_doubt(
        self, enclosure: Enclosure, contacts: Contacts, violations: Violations, first: tuple[int, ...]
    ) -> _Doubt:
        """Which pieces may be to blame for a violating word."""
        sets = contacts.sets
        # Pieces with one letter only matter where the formula counts triangles: they are cut last.
        blame = self._letters(contacts) > 1
        if not (blame & (enclosure.reach_m > self._finest_m)).any():
            blame = np.array([len(triangles) > 1 for triangles in sets[1:-1]])
        return _Doubt(blame, violations=violations, layers_from=first)

    def _proved(self, curve: JoinedCurve, enclosure: Enclosure, contacts: Contacts) -> Certificate:
        """The certificate of a curve about which nothing was found to fail."""
        return Certificate(
            holds=True,
            reason="every word that the tube can spell satisfies the specification, and it meets nothing restricted",
            where_s=None,
            where_m=None,
            knots_s=enclosure.knots_s,
            possible=tuple(contacts.sets[1:-1]),
            word=self._sure_word(contacts),
            clearance_m=self._touched.clearance_m(curve, enclosure),
            tube_m=self._tube_m,
            frequencies=curve.frequencies,
        )

    def _unsafe_place(self, enclosure: Enclosure, contacts: Contacts, doubt: _Doubt) -> Explanation:
        """The first place at which the tube leaves, or may leave, the domain, or meets something restricted."""
        knot = int((doubt.certain if len(doubt.certain) else np.flatnonzero(doubt.blame))[0])
        contact = min(knot, len(doubt.blame) - 1) + 1
        where_s, where = float(enclosure.knots_s[knot]), point(enclosure.points_m[knot])
        touched = contacts.triangles[contacts.pieces == contact]
        guilty = touched[self._restricted[touched]]
        names = sorted({name for t in guilty.tolist() for name in self._labelling.label(t)})
        what = f"cross {' and '.join(names) or 'a restricted triangle'}" if len(guilty) else "leave the domain"
        return Explanation(f"may {what} near {place(where, where_s)}", where_s, where, ())

    def _violating_flight(
        self,
        enclosure: Enclosure,
        contacts: Contacts,
        violations: Violations,
        first: tuple[int, ...],
        lap_from_s: float | None,
    ) -> Explanation:
        """What a flight does that violates the formula, the one that strays least from the middle of the tube."""
        centres = contacts.centres()
        ends = (*first[1:], len(centres))
        expected = tuple(frozenset(centres[begin:end].tolist()) for begin, end in zip(first, ends, strict=True))
        way, loop = violations.witness(expected)
        times = np.concatenate((enclosure.knots_s[:1], enclosure.knots_s))
        flight, lap = (
            tuple((float(times[first[layer]]), triangle) for layer, triangle in part) for part in (way, loop)
        )
        return explain(
            flight,
            enclosure,
            centres[1:-1],
            self._partition,
            self._labelling,
            refutation=self._refutation,
            sure=all(triangle in expected[layer] for layer, triangle in (*way, *loop)),
            ignored=self._restricted,
            lap=None if lap_from_s is None else Lap(lap, int(np.searchsorted(enclosure.knots_s, lap_from_s))),
        )

    def _sure_word(self, contacts: Contacts) -> tuple[frozenset[str], ...]:
        """The labels of the pieces in which only one is possible, equal neighbours once."""
        pieces, letters = self._letters_of(contacts)
        sure = letters[np.bincount(pieces, minlength=1)[pieces] == 1].tolist()
        return tuple(self._labelling.letters[letter] for letter, _ in groupby(sure))
