"""Each pattern's formula against its meaning in plain words, counted on words that are unrolled far enough."""

from collections.abc import Callable, Sequence
from itertools import pairwise, permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.formula import patterns
from mission.logic.formula.operators import Operator
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import TRUE, Formula, postorder, rebuilt
from mission.logic.formula.word import LassoWord, satisfies
from tests.support.drawn_cases import tried

NAMES = ("a", "b", "c")
UNROLLED = 9

APART = st.sampled_from([frozenset[str](), *(frozenset({name}) for name in NAMES)])
ANY = st.frozensets(st.sampled_from(NAMES))


def words(letters: st.SearchStrategy[frozenset[str]]) -> st.SearchStrategy[LassoWord]:
    # Words that go round are rare among random ones, and the ones that patrols are about.
    rounds = st.permutations([frozenset({name}) for name in NAMES])
    prefix = st.one_of(st.lists(letters, max_size=7), rounds)
    suffix = st.one_of(st.lists(letters, min_size=1, max_size=6), rounds)
    return st.builds(lambda first, again: LassoWord(tuple(first), tuple(again)), prefix, suffix)


def unrolled(word: LassoWord) -> list[frozenset[str]]:
    return [*word.prefix, *(word.suffix * UNROLLED)]


def visits(letters: Sequence[frozenset[str]], name: str) -> list[tuple[int, int]]:
    """First and last position inside a region of each visit, which only another region ends."""
    found: list[tuple[int, int]] = []
    over = True
    for i, letter in enumerate(letters):
        if name in letter:
            found = [*found, (i, i)] if over else [*found[:-1], (found[-1][0], i)]
        over = name not in letter and (over or bool(letter))
    return found


def first(word: LassoWord, name: str) -> float:
    return next((i for i, letter in enumerate(unrolled(word)) if name in letter), float("inf"))


def for_ever(word: LassoWord, name: str) -> bool:
    return any(name in letter for letter in word.suffix)


def in_sequence(letters: Sequence[frozenset[str]], names: Sequence[str]) -> bool:
    wanted = list(names)
    for letter in letters:
        while wanted and wanted[0] in letter:
            wanted.pop(0)
    return not wanted


def in_order(word: LassoWord, names: Sequence[str]) -> bool:
    return all(first(word, a) <= first(word, b) for a, b in pairwise(names))


def not_again_before(word: LassoWord, name: str, other: str) -> bool:
    letters = unrolled(word)
    return all(
        any(other in letter for letter in letters[left : entered + 1])
        for (_, left), (entered, _) in pairwise(visits(letters, name))
    )


def once_before(word: LassoWord, name: str, other: str) -> bool:
    return len(visits(unrolled(word)[: int(min(first(word, other), 999))], name)) <= 1


def fair(word: LassoWord, names: Sequence[str]) -> bool:
    return all(not_again_before(word, a, b) for a, b in permutations(names, 2))


def tour(word: LassoWord) -> list[str]:
    """The regions in the order in which they are visited, of a word of regions that lie apart."""
    letters = unrolled(word)
    return [name for _, name in sorted((begin, name) for name in NAMES for begin, _ in visits(letters, name))]


def followed(word: LassoWord, stimulus: str, reaction: str) -> bool:
    places = tour(word)
    stays = places[-1:] == [stimulus] and not any(for_ever(word, name) for name in NAMES if name != stimulus)
    return not stays and all(b == reaction for a, b in pairwise(places) if a == stimulus)


def entered_only_from(word: LassoWord, stimulus: str, reaction: str) -> bool:
    places = tour(word)
    at_start = bool(places) and reaction in unrolled(word)[0]
    before = [None, *places]
    return all(a == stimulus for a, b in pairwise(before[at_start:]) if b == reaction)


def counted(word: LassoWord, name: str) -> int:
    return len(visits(unrolled(word), name))


Meaning = Callable[[LassoWord, tuple[str, ...]], bool]

OF_LISTS: dict[str, Meaning] = {
    "visit": lambda word, names: all(first(word, name) < float("inf") for name in names),
    "sequenced_visit": lambda word, names: in_sequence(unrolled(word), names),
    "ordered_visit": lambda word, names: in_sequence(unrolled(word), names) and in_order(word, names),
    "strict_ordered_visit": lambda word, names: (
        in_sequence(unrolled(word), names)
        and in_order(word, names)
        and all(once_before(word, a, b) for a, b in pairwise(names))
    ),
    "fair_visit": lambda word, names: all(first(word, name) < float("inf") for name in names) and fair(word, names),
    "patrol": lambda word, names: all(for_ever(word, name) for name in names),
    "sequenced_patrol": lambda word, names: all(
        in_sequence(unrolled(word)[i:], names) for i in range(len(word.prefix) + len(word.suffix))
    ),
    "ordered_patrol": lambda word, names: (
        all(for_ever(word, name) for name in names)
        and in_order(word, names)
        and all(not_again_before(word, b, a) for a, b in pairwise(names))
    ),
    "fair_patrol": lambda word, names: all(for_ever(word, name) for name in names) and fair(word, names),
    "avoid": lambda word, names: all(first(word, name) == float("inf") for name in names),
}

OF_PAIRS: dict[str, Callable[[LassoWord], bool]] = {
    "avoid_until": lambda word: first(word, "b") < float("inf") and first(word, "a") >= first(word, "b"),
    "avoid_after": lambda word: all("a" not in letter for letter in unrolled(word)[int(min(first(word, "b"), 999)) :]),
    "wait": lambda word: (
        first(word, "b") < float("inf") and all("a" in letter for letter in unrolled(word)[: int(first(word, "b"))])
    ),
    "instantaneous_reaction": lambda word: all("b" in letter for letter in unrolled(word) if "a" in letter),
    "delayed_reaction": lambda word: (
        for_ever(word, "b")
        or max((end for _, end in visits(unrolled(word), "b")), default=-1)
        >= max((end for _, end in visits(unrolled(word), "a")), default=-1)
    ),
    "bound_reaction": lambda word: all(("a" in letter) == ("b" in letter) for letter in unrolled(word)),
}

COUNTS: dict[str, Callable[[int, int], bool]] = {
    "visits_at_most": lambda found, count: found <= count,
    "visits_at_least": lambda found, count: found >= count,
    "visits_exactly": lambda found, count: found == count,
}

OF_VISITS = {"strict_ordered_visit", "fair_visit", "ordered_patrol", "strict_ordered_patrol", "fair_patrol"}


def applied(kind: str, names: Sequence[str], places: Sequence[str] = NAMES) -> Formula:
    more = (places,) if kind in OF_VISITS else ()
    formula: Formula = getattr(patterns, kind)(names, *more)
    return formula


ALL: list[Formula] = [
    *(applied(kind, tuple(names)) for kind in (*OF_LISTS, "strict_ordered_patrol") for names in ("ab", "abc", "a")),
    *(getattr(patterns, kind)("a", "b") for kind in (*OF_PAIRS, "prompt_reaction", "bound_delay")),
    *(getattr(patterns, kind)("a", "b", NAMES) for kind in ("prompt_reaction", "bound_delay")),
    *(getattr(patterns, kind)("a", count, NAMES) for kind in COUNTS for count in (1, 2, 4)),
]


@pytest.mark.parametrize("kind", OF_LISTS)
@tried(100)
@given(word=st.one_of(words(ANY), words(APART)), names=st.permutations(NAMES), most=st.integers(1, 3))
def test_patterns_of_several_regions_mean_what_they_say(
    kind: str, word: LassoWord, names: list[str], most: int
) -> None:
    chosen = tuple(names[:most])
    assert satisfies(word, applied(kind, chosen)) == OF_LISTS[kind](word, chosen)


@pytest.mark.parametrize("kind", OF_PAIRS)
@tried(100)
@given(word=st.one_of(words(ANY), words(APART)))
def test_patterns_of_two_regions_mean_what_they_say(kind: str, word: LassoWord) -> None:
    assert satisfies(word, getattr(patterns, kind)("a", "b")) == OF_PAIRS[kind](word)


@pytest.mark.parametrize("kind", COUNTS)
@tried(100)
@given(word=words(ANY), count=st.integers(1, 4))
def test_visits_are_counted_and_not_letters(kind: str, word: LassoWord, count: int) -> None:
    assert satisfies(word, getattr(patterns, kind)("a", count, NAMES)) == COUNTS[kind](counted(word, "a"), count)


@tried(120)
@given(word=words(APART), names=st.permutations(NAMES), most=st.integers(2, 3), rounds=st.booleans())
def test_a_strict_patrol_goes_round_in_exactly_its_order(
    word: LassoWord, names: list[str], most: int, *, rounds: bool
) -> None:
    chosen = names[:most]
    if rounds:
        word = LassoWord(word.prefix, tuple(frozenset({name}) for name in chosen))
    places = [name for name in tour(word) if name in chosen]
    goes_round = all(name == chosen[i % most] for i, name in enumerate(places))
    for_all = all(for_ever(word, name) for name in chosen)
    assert satisfies(word, patterns.strict_ordered_patrol(chosen, NAMES)) == (goes_round and for_all)


@tried(150)
@given(word=words(APART))
def test_a_prompt_reaction_is_the_next_other_region(word: LassoWord) -> None:
    assert satisfies(word, patterns.prompt_reaction("a", "b", NAMES)) == followed(word, "a", "b")


@tried(150)
@given(word=words(APART))
def test_a_bound_delay_is_the_next_region_and_only_then(word: LassoWord) -> None:
    expected = followed(word, "a", "b") and entered_only_from(word, "a", "b")
    assert satisfies(word, patterns.bound_delay("a", "b", NAMES)) == expected


@tried(100)
@given(word=words(APART))
def test_fair_visits_differ_by_one_at_most_at_any_time(word: LassoWord) -> None:
    if satisfies(word, patterns.fair_visit(NAMES)):
        letters = unrolled(word)
        for i in range(len(letters)):
            numbers = [len(visits(letters[:i], name)) for name in NAMES]
            assert max(numbers) - min(numbers) <= 1


@pytest.mark.parametrize("formula", ALL, ids=str)
@tried(25)
@given(word=words(ANY), times=st.lists(st.integers(1, 3), min_size=13, max_size=13))
def test_no_pattern_sees_how_many_triangles_a_region_has(formula: Formula, word: LassoWord, times: list[int]) -> None:
    prefix = [letter for letter, n in zip(word.prefix, times, strict=False) for _ in range(n)]
    suffix = [letter for letter, n in zip(word.suffix, times[7:], strict=False) for _ in range(n)]
    assert satisfies(word, formula) == satisfies(LassoWord(tuple(prefix), tuple(suffix)), formula)


@pytest.mark.parametrize("formula", ALL, ids=str)
@tried(25)
@given(word=words(APART), times=st.integers(2, 3))
def test_no_pattern_sees_a_vehicle_that_sways_across_an_edge(formula: Formula, word: LassoWord, times: int) -> None:
    def swaying(letters: tuple[frozenset[str], ...]) -> tuple[frozenset[str], ...]:
        swayed: list[frozenset[str]] = []
        for letter, after in pairwise((*letters, letters[-1])):
            swayed += [letter, after] * times if letter and not after else [letter]
        return tuple(swayed)

    prefix = swaying(word.prefix) if word.prefix else ()
    assert satisfies(word, formula) == satisfies(LassoWord(prefix, swaying(word.suffix)), formula)


@pytest.mark.parametrize("formula", ALL, ids=str)
def test_each_is_written_without_next_and_reads_back(formula: Formula) -> None:
    assert all(node.operator is not Operator.NEXT for node in postorder(formula))
    assert parse_formula(str(formula)) is formula
    assert rebuilt(formula, lambda node, operands: Formula(node.operator, operands, node.name)) is formula


CATALOGUE = [
    # The catalogue's own example words that agree with its prose; # is another location.
    ("ordered_visit", "a c a b c #", "#", False),
    ("ordered_visit", "a # a b # c", "#", True),
    ("strict_ordered_visit", "a # a b # c", "#", False),
    ("strict_ordered_visit", "a # b # c", "#", True),
    ("sequenced_patrol", "a # c a # b", "a b c", True),
    ("sequenced_patrol", "a # c a # b", "a c", False),
    ("ordered_patrol", "a # c a # b", "a b c", False),
    ("ordered_patrol", "a a b # # c", "a b c", True),
    ("strict_ordered_patrol", "a # a b # c", "a b c", False),
    ("strict_ordered_patrol", "a # b # c", "a b c", True),
    ("fair_patrol", "a # c a # b", "a b a c", False),
]


@pytest.mark.parametrize(("kind", "prefix", "suffix", "expected"), CATALOGUE)
def test_the_catalogues_examples(kind: str, prefix: str, suffix: str, expected: bool) -> None:  # noqa: FBT001 - a table
    first_part, again = (tuple(frozenset({name}) for name in text.split()) for text in (prefix, suffix))
    assert satisfies(LassoWord(first_part, again), applied(kind, NAMES, [*NAMES, "#"])) is expected


def test_formulas_are_as_documented() -> None:
    assert str(patterns.sequenced_visit("abc")) == "F (a & F (b & F c))"
    assert str(patterns.strict_ordered_visit("ab", "c")) == (
        "F (a & F b) & !b U a & !a U (a & (a | !b & !c) U (!a U b))"
    )
    assert str(patterns.visits_at_most("a", 1, "abc")) == "!a W ((a | !b & !c) W G !a)"
    assert str(patterns.visits_at_least("a", 2, "c")) == "F (a & F (!a & c & F a))"
    assert str(patterns.prompt_reaction("a", "b", NAMES)) == "G (a -> a U (!c U b))"


def test_a_task_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="one region at least"):
        patterns.visit([])
    for kind in COUNTS:
        with pytest.raises(ValueError, match="one at least"):
            getattr(patterns, kind)("a", 0)
    assert patterns.avoid(["a"]) is not TRUE
