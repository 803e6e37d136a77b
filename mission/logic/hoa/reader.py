"""Reads automata in the Hanoi Omega-Automata format, versions 1 and 1.1.

Read are Büchi and generalised Büchi acceptance, on states and on transitions, and what comes to the same by any
conjunctions and disjunctions of sets that recur; labels on states and on edges, implicit labels, aliases, and several
initial states. Everything else that the format allows is refused, and so is a header that
contradicts itself or the body.

Source: the format's own description, https://adl.github.io/hoaf/.
"""

from collections.abc import Iterable
from typing import Final

from mission.logic.automata.automaton import GeneralisedBuchi, MarkedEdge
from mission.logic.automata.diagrams import MAX_CUBES, Diagram, Diagrams, TooLargeError
from mission.logic.automata.guards import Guard
from mission.logic.formula.syntax import proposition
from mission.logic.hoa.claims import Claims, Condition, Use
from mission.logic.hoa.tokens import Token, refusal, tokens

MAX_STATES: Final = 20_000
MAX_PROPOSITIONS: Final = 32
MAX_IMPLICIT: Final = 12
MAX_SETS: Final = 64
_VERSIONS: Final = ("v1", "v1.1")
_MAX_NESTING: Final = 100
_GROWTH: Final = 1_000_000  # nodes of diagrams for the labels


class Reader:
    """Reads one automaton; ``read`` may be called once."""

    def __init__(self, text: str) -> None:
        self._tokens = tokens(text)
        self._next = next(self._tokens)
        self._diagrams = Diagrams()
        self._aliases: dict[str, Diagram] = {}
        self._names: tuple[str, ...] = ()
        self._largest_proposition = Token("integer", "-1", 1, 1)
        self._declared: int | None = None
        self._starts: list[Token] = []
        self._condition: Condition = ()
        self._sets: int | None = None
        self._edges: list[tuple[int, Diagram, Token, int]] = []
        self._defined: dict[int, Token] = {}
        self._claims = Claims()
        self._diagrams.allow(_GROWTH)

    def read(self) -> GeneralisedBuchi:
        """The automaton, its states numbered as in the file.

        Raises:
            SpecError: The text is no such automaton, or one that this reader refuses; with line, column and reason.
        """
        try:
            self._header()
            self._body()
            return self._finished()
        except TooLargeError as error:
            raise refusal("the labels of this automaton are too complicated", self._next) from error

    # Tokens

    def _take(self) -> Token:
        token = self._next
        self._next = next(self._tokens)
        return token

    def _expect(self, kind: str, text: str = "") -> Token:
        token = self._take()
        if token.kind != kind or (text and token.text != text):
            raise refusal(f"{text or kind} is expected here, not {token.shown}", token)
        return token

    def _at(self, kind: str, text: str = "") -> bool:
        return self._next.kind == kind and (not text or self._next.text == text)

    def _integer(self) -> int:
        return int(self._expect("integer").text)

    # Header

    def _header(self) -> None:
        first = self._expect("header")
        if first.text != "HOA":
            raise refusal("the automaton does not begin with HOA:", first, "begin with HOA: v1")
        version = self._expect("identifier")
        if version.text not in _VERSIONS:
            raise refusal(f"version {version.text} of the format is not known", version, "write HOA: v1")
        items = {
            "States": self._states,
            "Start": self._start,
            "AP": self._propositions,
            "Alias": self._alias,
            "Acceptance": self._acceptance,
        }
        seen: set[str] = set()
        while self._at("header"):
            item = self._take()
            if item.text in seen and item.text not in ("Start", "Alias", "properties"):
                raise refusal(f"{item.text}: occurs twice", item)
            seen.add(item.text)
            if item.text in items:
                items[item.text](item)
            elif item.text[0].isupper():
                raise refusal(f"{item.text}: is not known, and could change the meaning of the automaton", item)
            else:
                values = []
                while self._next.kind in ("identifier", "integer", "string") or self._at("symbol", "!"):
                    values.append(self._take())
                self._claims.note(item, values)
        body = self._expect("mark", "--BODY--")
        self._claims.check_name(self._sets or 0, self._condition)
        if self._sets is None:
            raise refusal("Acceptance: is missing", body, "add Acceptance: 1 Inf(0)")
        if not self._starts:
            raise refusal("Start: is missing, so that nothing is accepted", body, "add Start: 0")

    def _states(self, item: Token) -> None:
        self._declared = self._integer()
        if self._declared > MAX_STATES:
            raise refusal(f"more than {MAX_STATES} states", item)

    def _start(self, item: Token) -> None:
        self._starts.append(self._state_number(item))

    def _state_number(self, item: Token) -> Token:
        token = self._expect("integer")
        if self._at("symbol", "&"):
            raise refusal("a conjunction of states makes the automaton alternating, which is not read", item)
        if int(token.text) >= MAX_STATES:
            raise refusal(f"state {token.text} is beyond the limit of {MAX_STATES} states", token)
        return token

    def _propositions(self, item: Token) -> None:
        number = self._integer()
        names: list[str] = []
        while self._at("string"):
            token = self._take()
            try:
                names.append(proposition(token.text).name)
            except ValueError as error:
                raise refusal(str(error), token) from error
        if len(names) != number:
            raise refusal(f"{number} propositions are announced, and {len(names)} are named", item)
        if len(set(names)) != len(names):
            raise refusal("a proposition is named twice", item)
        if number > MAX_PROPOSITIONS:
            raise refusal(f"more than {MAX_PROPOSITIONS} propositions", item)
        self._names = tuple(names)

    def _alias(self, item: Token) -> None:
        name = self._expect("alias")
        if name.text in self._aliases:
            raise refusal(f"the alias {name.text} is defined twice", name)
        self._aliases[name.text] = self._label(item, 0)

    def _acceptance(self, item: Token) -> None:
        sets = self._integer()
        if sets > MAX_SETS:
            raise refusal(f"more than {MAX_SETS} acceptance sets", item)
        self._sets = sets
        self._condition = self._alternatives(item, 0)

    def _alternatives(self, item: Token, depth: int) -> Condition:
        condition = self._together(item, depth)
        while self._at("symbol", "|"):
            self._take()
            condition = _either(condition, self._together(item, depth), item)
        return condition

    def _together(self, item: Token, depth: int) -> Condition:
        condition = self._part(item, depth)
        while self._at("symbol", "&"):
            self._take()
            condition = _shortest((*condition, *self._part(item, depth)))
        return condition

    def _part(self, item: Token, depth: int) -> Condition:
        token = self._take()
        if token.kind == "symbol" and token.text == "(" and depth < _MAX_NESTING:
            condition = self._alternatives(item, depth + 1)
            self._expect("symbol", ")")
            return condition
        if token.kind == "identifier" and token.text == "Inf":
            return (frozenset({self._infinitely(item)}),)
        if token.kind == "identifier" and token.text == "t":
            return ()
        hint = "Büchi is Acceptance: 1 Inf(0), generalised Büchi Acceptance: 2 Inf(0)&Inf(1)"
        raise refusal(f"{token.shown} is in no Büchi or generalised Büchi condition", token, hint)

    def _infinitely(self, item: Token) -> tuple[int, bool]:
        self._expect("symbol", "(")
        wanted = not self._at("symbol", "!")
        if not wanted:
            self._take()
        index = self._integer()
        self._expect("symbol", ")")
        if index >= (self._sets or 0):
            raise refusal(f"acceptance set {index} does not exist: there are {self._sets}", item)
        return index, wanted

    # Labels

    def _label(self, item: Token, depth: int) -> Diagram:
        result = self._label_term(item, depth)
        while self._at("symbol", "|"):
            self._take()
            result = self._diagrams.either(result, self._label_term(item, depth))
        return result

    def _label_term(self, item: Token, depth: int) -> Diagram:
        result = self._label_factor(item, depth)
        while self._at("symbol", "&"):
            self._take()
            result = self._diagrams.both(result, self._label_factor(item, depth))
        return result

    def _label_factor(self, item: Token, depth: int) -> Diagram:
        negated = False
        while self._at("symbol", "!"):
            self._take()
            negated = not negated
        token = self._take()
        if token.kind == "integer":
            result = self._proposition(token)
        elif token.kind == "alias":
            if token.text not in self._aliases:
                raise refusal(f"the alias {token.text} is not defined before", token)
            result = self._aliases[token.text]
        elif token.kind == "identifier" and token.text in ("t", "f"):
            result = self._diagrams.true if token.text == "t" else self._diagrams.false
        elif token.kind == "symbol" and token.text == "(" and depth < _MAX_NESTING:
            result = self._label(item, depth + 1)
            self._expect("symbol", ")")
        else:
            raise refusal(f"{token.shown} is no part of a label", token)
        return self._diagrams.neither(result) if negated else result

    def _proposition(self, token: Token) -> Diagram:
        if int(token.text) >= MAX_PROPOSITIONS:
            raise refusal(f"proposition {token.text} does not exist", token)
        if int(token.text) > int(self._largest_proposition.text):
            self._largest_proposition = token
        return self._diagrams.literal(int(token.text))

    # Body

    def _body(self) -> None:
        while self._at("header", "State"):
            self._state(self._take())
        if not self._at("mark", "--END--"):
            raise refusal(f"State: or --END-- is expected here, not {self._next.shown}", self._next)
        self._take()
        if self._next.kind != "end":
            raise refusal("something follows the automaton; one automaton is read", self._next)

    def _state(self, item: Token) -> None:
        opening = self._next
        shared = self._bracketed() if self._at("symbol", "[") else None
        if shared is not None:
            self._claims.use(Use.STATE_LABEL, opening)
        number = self._state_number(item)
        state = int(number.text)
        if state in self._defined:
            raise refusal(f"state {state} is defined twice, first in line {self._defined[state].line}", number)
        self._defined[state] = number
        if self._at("string"):
            self._take()
        marks = self._marks(Use.STATE_MARK)
        edges: list[tuple[Diagram | None, Token, int]] = []
        while self._at("symbol", "[") or self._at("integer"):
            opening = self._next
            label = self._bracketed() if self._at("symbol", "[") else None
            if label is not None and shared is not None:
                raise refusal(f"state {state} has a label, so that its edges have none", opening)
            target = self._state_number(opening)
            edges.append((label, target, marks | self._marks(Use.EDGE_MARK)))
        labels = self._labels(number, shared, [label for label, _, _ in edges])
        for label, (_, target, bits) in zip(labels, edges, strict=True):
            self._edges.append((state, label, target, bits))

    def _labels(self, state: Token, shared: Diagram | None, labels: list[Diagram | None]) -> list[Diagram]:
        if shared is not None:
            return [shared] * len(labels)
        found = [label for label in labels if label is not None]
        if found or not labels:
            if len(found) < len(labels):
                raise refusal(f"some edges of state {state.text} have labels and some have none", state)
            if found:
                self._claims.use(Use.EDGE_LABEL, state)
            return found
        self._claims.use(Use.IMPLICIT_LABEL, state)
        if len(self._names) > MAX_IMPLICIT:
            raise refusal(f"implicit labels are read for {MAX_IMPLICIT} propositions at most", state)
        letters = 1 << len(self._names)
        if len(labels) != letters:
            raise refusal(f"state {state.text} has {len(labels)} edges without labels, not {letters}", state)
        return [self._diagrams.cube((bits, bits ^ letters - 1)) for bits in range(letters)]

    def _bracketed(self) -> Diagram:
        item = self._expect("symbol", "[")
        label = self._label(item, 0)
        self._expect("symbol", "]")
        return label

    def _marks(self, use: Use) -> int:
        bits = 0
        if self._at("symbol", "{"):
            self._claims.use(use, self._take())
            while self._at("integer"):
                token = self._take()
                if int(token.text) >= (self._sets or 0):
                    raise refusal(f"acceptance set {token.text} does not exist: there are {self._sets}", token)
                bits |= 1 << int(token.text)
            self._expect("symbol", "}")
        return bits

    # The whole

    def _finished(self) -> GeneralisedBuchi:
        targets = [*self._defined.values(), *self._starts, *(target for _, _, target, _ in self._edges)]
        size = self._declared if self._declared is not None else 1 + max(int(token.text) for token in targets)
        for token in targets:
            if int(token.text) >= size:
                raise refusal(f"state {token.text} does not exist: there are {size}", token)
            if int(token.text) not in self._defined:
                hint = f"add State: {token.text}, with no edges if none is meant to leave it"
                raise refusal(f"state {token.text} is never defined", token, hint)
        if int(self._largest_proposition.text) >= len(self._names):
            raise refusal(f"proposition {self._largest_proposition.text} does not exist", self._largest_proposition)
        letters: dict[tuple[int, int, tuple[int, ...]], Diagram] = {}
        for state, label, target, bits in self._edges:
            marks = tuple(
                number
                for number, sets in enumerate(self._condition)
                if any(bool(bits >> index & 1) is wanted for index, wanted in sets)
            )
            key = (state, int(target.text), marks)
            letters[key] = self._diagrams.either(letters.get(key, self._diagrams.false), label)
        guards = self._guards(dict.fromkeys(letters.values()))
        edges = tuple(
            MarkedEdge(source, guards[letters[source, target, marks]], target, marks)
            for source, target, marks in sorted(letters)
            if letters[source, target, marks] != self._diagrams.false
        )
        initial = tuple(sorted({int(token.text) for token in self._starts}))
        automaton = GeneralisedBuchi(self._names, size, initial, len(self._condition), edges)
        self._claims.check(automaton)
        return automaton

    def _guards(self, labels: Iterable[Diagram]) -> dict[Diagram, Guard]:
        """Each label as a guard; all together have no more cubes than one may have."""
        guards: dict[Diagram, Guard] = {}
        cubes = 0
        for label in labels:
            guards[label] = Guard(self._names, self._diagrams.cover(label))
            cubes += len(guards[label].cubes)
            if cubes > MAX_CUBES:
                raise TooLargeError
        return guards


def _either(one: Condition, other: Condition, item: Token) -> Condition:
    """What recurs in one of two ways: from each, some member of each union of a union of either."""
    if len(one) * len(other) > MAX_SETS:
        raise refusal(f"the condition has more than {MAX_SETS} acceptance sets when it is multiplied out", item)
    return _shortest(tuple(left | right for left in one for right in other))


def _shortest(condition: Condition) -> Condition:
    """A condition without unions that are met wherever another one is, each once."""
    unions = dict.fromkeys(condition)
    return tuple(sets for sets in unions if not any(other < sets for other in unions))
