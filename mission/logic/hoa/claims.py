"""What the header of an HOA file says a second time: the name of the acceptance, and properties of the automaton.

Neither has a meaning of its own, but where one contradicts the rest of the file, the automaton is hardly the one that
its writer meant. Properties that are not listed here are not checked.
"""

from collections.abc import Callable, Sequence
from enum import Enum
from itertools import pairwise
from typing import Final

from mission.logic.automata.automaton import GeneralisedBuchi
from mission.logic.hoa.tokens import Token, refusal

Condition = tuple[frozenset[tuple[int, bool]], ...]
"""What must recur: of each union, some transition in one of its sets; a set goes with whether it or its complement is
meant."""


class Use(Enum):
    """How a body is written; the value is what a message calls it."""

    STATE_LABEL = "a state has a label"
    EDGE_LABEL = "edges have labels"
    IMPLICIT_LABEL = "edges have no labels"
    STATE_MARK = "a state is in acceptance sets"
    EDGE_MARK = "an edge is in acceptance sets"


_EXCLUDED: Final = {
    "state-labels": (Use.EDGE_LABEL, Use.IMPLICIT_LABEL),
    "trans-labels": (Use.STATE_LABEL,),
    "implicit-labels": (Use.STATE_LABEL, Use.EDGE_LABEL),
    "explicit-labels": (Use.IMPLICIT_LABEL,),
    "state-acc": (Use.EDGE_MARK,),
    "trans-acc": (Use.STATE_MARK,),
}
_FACTS: Final[dict[str, Callable[[GeneralisedBuchi], bool]]] = {
    "deterministic": lambda automaton: automaton.deterministic,
    "complete": lambda automaton: automaton.complete,
}
_NEVER_BUCHI: Final = frozenset({"co-Buchi", "generalized-co-Buchi", "Rabin", "generalized-Rabin", "none"})


class Claims:
    """Collects what a file says of itself, and checks it."""

    def __init__(self) -> None:
        self._name: list[Token] = []
        self._properties: list[Token] = []
        self._denied: list[Token] = []
        self._uses: dict[Use, Token] = {}

    def note(self, item: Token, values: Sequence[Token]) -> None:
        """Remember a header item if it is one of those that are checked."""
        if item.text == "acc-name":
            self._name = list(values)
        elif item.text == "properties":
            for before, claim in pairwise((item, *values)):
                if before.kind == "symbol":
                    self._denied.append(claim)
                elif claim.kind != "symbol":
                    self._properties.append(claim)

    def use(self, use: Use, token: Token) -> None:
        """Remember the first place where the body is written in some way."""
        self._uses.setdefault(use, token)

    def check_name(self, sets: int, condition: Condition) -> None:
        """Compare the name of the acceptance with the condition.

        Raises:
            SpecError: They do not agree.
        """
        if not self._name:
            return
        name, *parameters = self._name
        wanted: int | None = None
        if name.text == "Buchi":
            wanted = 1
        elif name.text == "all":
            wanted = 0
        elif name.text == "generalized-Buchi":
            wanted = int(parameters[0].text) if parameters and parameters[0].kind == "integer" else -1
        plain = set(condition) == {frozenset({(index, True)}) for index in range(sets)}
        if name.text in _NEVER_BUCHI or (wanted is not None and not (plain and wanted == sets)):
            shown = " ".join(token.text for token in self._name)
            raise refusal(f"acc-name: says {shown}, and Acceptance: something else", name)

    def check(self, automaton: GeneralisedBuchi) -> None:
        """Compare the properties with the body and with the automaton that was read.

        Raises:
            SpecError: They do not agree.
        """
        for claim in self._properties:
            if claim.text == "univ-branch":
                raise refusal("universal branching makes the automaton alternating, which is not read", claim)
            for use in _EXCLUDED.get(claim.text, ()):
                if use in self._uses:
                    raise refusal(
                        f"properties: says {claim.text}, but in line {self._uses[use].line} {use.value}", claim
                    )
            if claim.text in _FACTS and not _FACTS[claim.text](automaton):
                raise refusal(f"properties: says {claim.text}, and the automaton is not", claim)
        for claim in self._denied:
            if claim.text in _FACTS and _FACTS[claim.text](automaton):
                raise refusal(f"properties: says !{claim.text}, and the automaton is {claim.text}", claim)
