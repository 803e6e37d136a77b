"""``mission automaton``: the Büchi automaton of a formula or a file, shown in several forms, or two compared."""

import json
from argparse import Namespace
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from mission.cli.inputs import bad_file, write_named
from mission.cli.option_values import FORMATS
from mission.cli.screen import out
from mission.decimals import count
from mission.errors import AutomatonSizeError, Fault, SpecError, reason
from mission.logic.automata.automaton import BuchiAutomaton, GeneralisedBuchi
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.equivalence import Language, telling_word
from mission.logic.automata.translate import SHOWN, Bounds, translate, translate_generalised
from mission.logic.formula.conjuncts import separated
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.logic.hoa.text import parse_generalised, to_hoa
from mission.logic.hoa.tokens import MAX_LENGTH
from mission.spec.finding import shortened

_PICTURES = tuple(f".{name}" for name in sorted(FORMATS))
_FILES = ".hoa"
_PAIR = 2

_Automaton = TypeVar("_Automaton", BuchiAutomaton, GeneralisedBuchi)


@dataclass(frozen=True)
class _Named:
    """What the command line names: a formula, or the automaton of a file.

    Attributes:
        name: How it was written.
        meaning: What it is.
    """

    name: str
    meaning: Formula | GeneralisedBuchi

    @cached_property
    def automaton(self) -> BuchiAutomaton:
        """An automaton of it with accepting states."""
        if isinstance(self.meaning, Formula):
            return _smaller_asked_for(translate, self.meaning)
        return with_accepting_states(self.meaning)

    @property
    def generalised(self) -> GeneralisedBuchi:
        """One with accepting transitions; a file's is as it stands there."""
        if isinstance(self.meaning, Formula):
            return _smaller_asked_for(translate_generalised, self.meaning)
        return self.meaning

    @property
    def language(self) -> Language:
        """Its words, and all others."""
        if isinstance(self.meaning, Formula):
            return Language.of_formula(self.meaning)
        return Language.of_automaton(self.meaning)

    def accepts(self, word: LassoWord) -> bool:
        """Whether a word is one of its words: of a formula, by the definition."""
        return satisfies(word, self.meaning) if isinstance(self.meaning, Formula) else self.automaton.accepts(word)


def _smaller_asked_for(make: Callable[[Formula, Bounds], _Automaton], formula: Formula) -> _Automaton:
    """An automaton within the bounds of what is shown; where it is not, what can be shown instead is said."""
    try:
        return make(formula, SHOWN)
    except AutomatonSizeError as error:
        parts = separated(formula)
        cure = "give a smaller formula"
        if len(parts) > 1:
            cure = (
                f"it is a conjunction of {len(parts)} formulas: give one of them, such as `{shortened(str(parts[0]))}`"
            )
        raise AutomatonSizeError(f"{error}; {cure}") from error


def run(arguments: Namespace) -> int:
    """Translate or read, and show or compare; a picture is written first, whoever reads the rest."""
    picture = None if arguments.picture is None else _picture_file(arguments.picture)
    named = [_named(language) for language in arguments.languages]
    if len(named) > 1:
        return _compared(named, arguments)
    (shown,) = named
    if picture is not None:
        _draw(shown, picture)
    if arguments.form == "generalised":
        _print(to_hoa(shown.generalised))
    else:
        write = {"hoa": to_hoa, "dot": to_dot, "json": to_json, "table": to_table}[arguments.form]
        _print(write(shown.automaton))
    return 0


def _named(text: str) -> _Named:
    if not text.lower().endswith(_FILES):
        formula = parse_formula(text)
        return _Named(str(formula), formula)
    file = Path(text)
    try:
        with file.open("rb") as stream:
            content = stream.read(4 * MAX_LENGTH + 1).decode("utf-8-sig")
        return _Named(text, parse_generalised(content))
    except UnicodeDecodeError as error:
        raise bad_file(file, "is not UTF-8", "name a file in the Hanoi Omega-Automata format") from error
    except OSError as error:
        hint = f"name a file that can be read, or write '\"{text}\"' for the proposition of that name"
        raise bad_file(file, f"cannot be read: {reason(error)}", hint) from error
    except SpecError as error:
        raise SpecError(tuple(replace(fault, path="") for fault in error.faults), text) from error


def _compared(named: list[_Named], arguments: Namespace) -> int:
    """Say whether two are equivalent, and of a word that tells them apart, which of them it belongs to."""
    if len(named) > _PAIR or arguments.picture is not None or arguments.form not in ("table", "json"):
        message = "two are compared at a time, as a line or as JSON, and not drawn"
        hint = "give two formulas or files, with --json or without"
        raise SpecError((Fault(0, 0, "automaton", message, hint),))
    word = telling_word(named[0].language, named[1].language)
    belongs = [] if word is None else [one.accepts(word) for one in named]
    if arguments.form == "json":
        parts = None if word is None else {"prefix": word.prefix, "suffix": word.suffix}
        told = None if parts is None else {name: [sorted(letter) for letter in part] for name, part in parts.items()}
        _print(json.dumps({"equivalent": word is None, "word": told, "accepted": belongs}, ensure_ascii=False))
    elif word is None:
        _print("equivalent: both accept the same words")
    else:
        (yes,) = (one.name for one, belonging in zip(named, belongs, strict=True) if belonging)
        (no,) = (one.name for one, belonging in zip(named, belongs, strict=True) if not belonging)
        _print(f"not equivalent: {_spelled(word)}\n  is accepted by  {yes}\n  and not by      {no}")
    return 0 if word is None else 1


def _spelled(word: LassoWord) -> str:
    """A lasso word as text: each letter in braces, what repeats for ever in round brackets."""
    prefix, suffix = (
        " ".join(f"{{{', '.join(sorted(letter))}}}" for letter in part) for part in (word.prefix, word.suffix)
    )
    return f"{prefix} ({suffix})*".lstrip()


def _print(text: str) -> None:
    out.out(text.rstrip("\n"), highlight=False)


def _picture_file(name: str) -> Path:
    file = Path(name)
    if file.suffix.lower() not in _PICTURES:
        kinds = f"{', '.join(_PICTURES[:-1])} or {_PICTURES[-1]}"
        message = f"{name!r} does not say which kind of picture to draw"
        raise SpecError((Fault(0, 0, "--picture", message, f"give the file a name that ends in {kinds}"),))
    return file


def _draw(shown: _Named, file: Path) -> None:
    # Drawing is loaded when it is asked for.
    from mission.report.figures.automaton import automaton_of_formula  # noqa: PLC0415
    from mission.report.figures.canvas import WRITERS  # noqa: PLC0415

    written = WRITERS[file.suffix.lower().removeprefix(".")]
    write_named("--picture", file, written(automaton_of_formula(shown.automaton, shown.name)))


def to_table(automaton: BuchiAutomaton) -> str:
    """States and edges, for people."""
    kind = "deterministic" if automaton.deterministic else "nondeterministic"
    lines = [f"{count(automaton.size, 'state')}, {count(automaton.edge_count, 'edge')}, {kind}"]
    for state, edges in enumerate(automaton.outgoing):
        members = {"initial": automaton.initial, "accepting": automaton.accepting}
        marks = [mark for mark, those in members.items() if state in those]
        lines.append(f"q{state}{'  ' if marks else ''}{', '.join(marks)}")
        lines += [f"    {edge.guard}  ->  q{edge.target}" for edge in edges]
    return "\n".join(lines)


def to_json(automaton: BuchiAutomaton) -> str:
    """The automaton for programs; ``states``, ``edges`` and ``deterministic`` are its figures."""
    return json.dumps(
        {
            "states": automaton.size,
            "edges": automaton.edge_count,
            "deterministic": automaton.deterministic,
            "propositions": list(automaton.propositions),
            "initial": list(automaton.initial),
            "accepting": sorted(automaton.accepting),
            "transitions": [[edge.source, str(edge.guard), edge.target] for edge in automaton.edges],
        },
        ensure_ascii=False,
    )


def to_dot(automaton: BuchiAutomaton) -> str:
    """The automaton in the language of Graphviz."""
    lines = ["digraph automaton {", "  rankdir=LR;", "  node [shape=circle];"]
    lines += [f"  q{state} [shape=doublecircle];" for state in sorted(automaton.accepting)]
    for state in automaton.initial:
        lines += [f'  start{state} [shape=point, label=""];', f"  start{state} -> q{state};"]
    for edge in automaton.edges:
        guard = str(edge.guard).replace("\\", "\\\\").replace('"', '\\"')
        lines.append(f'  q{edge.source} -> q{edge.target} [label="{guard}"];')
    return "\n".join([*lines, "}"])
