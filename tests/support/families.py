"""Formulas that other translators have been compared on, written from their published definitions.

Each family grows with a number. None of them is a target of this project; they show where a translator is slow.
"""

from collections.abc import Callable, Iterable

ETESSAMI_HOLZMANN = (
    "p0 U (p1 & G p2)",
    "p0 U (p1 & X (p2 U p3))",
    "p0 U (p1 & X (p2 & F (p3 & X F (p4 & X F (p5 & X F p6)))))",
    "F (p0 & X G p1)",
    "F (p0 & X (p1 & X F p2))",
    "F (p0 & X (p1 U p2))",
    "F G p0 | G F p1",
    "G (p0 -> p1 U p2)",
    "G (p0 & X F (p1 & X F (p2 & X F p3)))",
    "G F p0 & G F p1 & G F p2 & G F p3 & G F p4",
    "p0 U (p1 U p2) | p1 U (p2 U p0) | p2 U (p0 U p1)",
    "G (p0 -> p1 U (G p2 | G p3))",
)
"""Of "Optimizing Büchi automata" (2000)."""

SOMENZI_BLOEM = (
    "p0 U p1",
    "p0 U (p1 U p2)",
    "!(p0 U (p1 U p2))",
    "G F p0 -> G F p1",
    "F p0 U G p1",
    "G p0 U p1",
    "!(F F p0 <-> F p0)",
    "!(G F p0 -> G F p1)",
    "!(G F p0 <-> G F p1)",
    "p0 R (p0 | p1)",
    "(X p0 U X p1) | !X (p0 U p1)",
    "(X p0 U p1) | !X (p0 U (p0 & p1))",
    "G (p0 -> F p1) & ((X p0 U p1) | !X (p0 U (p0 & p1)))",
    "G (p0 -> F p1) & ((X p0 U X p1) | !X (p0 U p1))",
    "G (p0 -> F p1)",
    "!G (p0 -> X (p1 R p2))",
    "!(F G p0 | F G p1)",
    "G (F p0 & F p1)",
    "F p0 & F !p0",
    "(p0 & X p1) R X (((p2 U p3) R p0) U (p2 R p0))",
    "G (p1 | G F p0) & G (p2 | G F !p0) | G p1 | G p2",
    "G (p1 | F G p0) & G (p2 | F G !p0) | G p1 | G p2",
    "!(G (p1 | G F p0) & G (p2 | G F !p0) | G p1 | G p2)",
    "!(G (p1 | F G p0) & G (p2 | F G !p0) | G p1 | G p2)",
    "G (p0 | X G p1) & G (p2 | X G !p1)",
    "G (p0 | X p1 & X !p1)",
    "(p0 U p0) | (p1 U p0)",
)
"""Of "Efficient Büchi automata from LTL formulae" (2000)."""


def _each(number: int, text: str, joined_by: str = "&") -> str:
    """``text`` for i from 1 to ``number``, with j the number after i."""
    return f" {joined_by} ".join(f"({text.format(i=i, j=i + 1)})" for i in range(1, number + 1))


def _nested(parts: Iterable[str], last: str) -> str:
    """The parts around each other, the first outermost: each has one hole for the next."""
    text = last
    for part in reversed(list(parts)):
        text = part.format(text)
    return text


def _visits(name: str, number: int) -> str:
    return _nested((f"F ({name}{i} & {{}})" for i in range(1, number)), f"F {name}{number}")


def _steps(name: str, number: int) -> str:
    return _nested((f"({name}{i} & X {{}})" for i in range(1, number)), f"{name}{number}")


def _left(operator: str, number: int) -> str:
    return _nested((f"({{}} {operator} p{i})" for i in range(number, 1, -1)), "p1")


def _right(operator: str, number: int) -> str:
    return _nested((f"(p{i} {operator} {{}})" for i in range(1, number)), f"p{number}")


FAMILIES: dict[str, Callable[[int], str]] = {
    # Gastin and Oddoux, "Fast LTL to Büchi automata translation" (2001).
    "theta": lambda n: f"!(({_each(n, 'G F p{i}')}) -> G (q -> F r))",
    # Geldenhuys and Hansen, "Larger automata and less work for LTL model checking" (2006).
    "E": lambda n: _each(n, "F p{i}"),
    "S": lambda n: _each(n, "G p{i}"),
    "C1": lambda n: _each(n, "G F p{i}", "|"),
    "C2": lambda n: _each(n, "G F p{i}"),
    "Q": lambda n: _each(n, "F p{i} | G p{j}"),
    "R": lambda n: _each(n, "G F p{i} | F G p{j}"),
    "U left": lambda n: _left("U", n),
    "U right": lambda n: _right("U", n),
    "R left": lambda n: _left("R", n),
    "R right": lambda n: _right("R", n),
    "W left": lambda n: _left("W", n),
    "M left": lambda n: _left("M", n),
    # Cichoń, Czubak and Jasiński, "Minimal Büchi automata for certain classes of LTL formulas" (2009).
    "alpha": lambda n: f"{_visits('p', n)} & {_visits('q', n)}",
    "beta": lambda n: f"F {_steps('p', n)} & F {_steps('q', n)}",
    # Müller and Sickert, "LTL to deterministic Emerson-Lei automata" (2017).
    "steps again and again": lambda n: f"G F {_steps('p', n)} & {_visits('q', n)}",
    # Tabakov and Vardi, "Optimized temporal monitors for SystemC" (2010).
    "within n": lambda n: f"G (p -> ({' | '.join('X ' * i + 'q' for i in range(n))}))",
    "for n": lambda n: f"G (p -> ({' & '.join('X ' * i + 'q' for i in range(n))}))",
    # Sickert, Esparza, Jaax and Křetínský, "Limit-deterministic Büchi automata for linear temporal logic" (2016).
    "Streett": lambda n: _each(n, "G F p{i} -> G F q{i}"),
    "general fairness": lambda n: f"({_each(n, 'G F p{i}')}) -> ({_each(n, 'G F q{i}')})",
    # Fairness and what users of model checkers and synthesis write.
    "fairness": lambda n: f"({_each(n, 'G F p{i}')}) -> G F q",
    "fair equivalence": lambda n: f"({_each(n, 'G F p{i}')}) <-> G F q",
    "responses": lambda n: _each(n, "G (p{i} -> F q{i})"),
    "chain of responses": lambda n: _each(n, "G (p{i} -> F p{j})"),
    "chained response": lambda n: f"G (q -> {_visits('p', n)})",
    "persistence": lambda n: _each(n, "F G p{i}", "|"),
    # Missions beyond those that are targets.
    "recharge": lambda n: f"{_each(n, 'F p{i}')} & G (low -> ({_each(n, '!p{i}')}) U base)",
    "patrol and react": lambda n: f"{_each(n, 'G F p{i}')} & G (e -> F h) & G !k",
    "patrol after start": lambda n: f"F (s & {_each(n, 'G F p{i}')})",
    "patrol in order": lambda n: f"G {_visits('p', n)} & G !k",
    "precedence": lambda n: _each(n, "!p{j} U p{i}"),
}
