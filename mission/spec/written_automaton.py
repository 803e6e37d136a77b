"""An automaton that is written in the mission file itself, as the paper's user gives it: states, edges, which accept.

It becomes the text of the Hanoi Omega-Automata format, version 1 (https://adl.github.io/hoaf/), and from there on it is
like one in a file.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

from mission.errors import FormulaSyntaxError
from mission.logic.formula.operators import TEMPORAL, Operator
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula, postorder, proposition_order
from mission.spec.finding import Finding, Path, rather, shortened
from mission.spec.shape_schema import mapping

BY_HAND: Final = "by hand"
"""What such an automaton has in the place of its file's name."""

_PATH: Final[Path] = ("mission", "automaton")
_JOINED: Final = {Operator.AND: "&", Operator.OR: "|"}

_STATE: Final = {
    "anyOf": [{"type": "string", "minLength": 1, "maxLength": 60}, {"type": "integer", "minimum": 0}],
    "examples": ["begun"],
}
SCHEMA: Final[dict[str, Any]] = mapping(
    "A Büchi automaton, state by state; an edge that is not there is not taken.",
    ("states", "edges", "accepting"),
    {
        "states": {
            "description": "The names of its states; the flight begins in the first, unless `initial` names another.",
            "type": "array",
            "items": _STATE,
            "minItems": 1,
            "maxItems": 1_000,
            "uniqueItems": True,
            "examples": [["begun", "seen", "done"]],
        },
        "initial": {"description": "Where it begins, instead of in the first of `states`.", **_STATE},
        "accepting": {
            "description": "A word is accepted if it leads through one of these again and again.",
            "type": "array",
            "items": _STATE,
            "minItems": 1,
            "maxItems": 1_000,
            "examples": [["done"]],
        },
        "edges": {
            "description": "What leads from state to state.",
            "type": "array",
            "minItems": 1,
            "maxItems": 10_000,
            "examples": [[{"from": "begun", "to": "seen", "when": "S1 & !K1"}]],
            "items": mapping(
                "One edge.",
                ("from", "to"),
                {
                    "from": {"description": "The state that it leaves.", **_STATE},
                    "to": {"description": "The state that it enters.", **_STATE},
                    "when": {
                        "description": "What must hold where the vehicle is: region names with ! & | -> <->.",
                        "type": "string",
                        "minLength": 1,
                        "maxLength": 10_000,
                        "default": "true",
                        "examples": ["S1 & !K1"],
                    },
                },
            ),
        },
    },
    examples=[
        {
            "states": ["begun", "done"],
            "accepting": ["done"],
            "edges": [
                {"from": "begun", "to": "begun", "when": "!S1"},
                {"from": "begun", "to": "done", "when": "S1"},
                {"from": "done", "to": "done"},
            ],
        }
    ],
)


def written_automaton(value: Mapping[str, Any], names: frozenset[str] | None) -> tuple[str, list[Finding]]:
    """The automaton in the Hanoi Omega-Automata format, and what is wrong with it; empty where something is.

    Args:
        value: As in the mission file, of sound structure.
        names: Names of the regions; None where they are not known.
    """
    states = {str(name): number for number, name in enumerate(value["states"])}
    findings = [*_unknown_states(value, states)]
    guards = []
    for number, edge in enumerate(value["edges"]):
        guard, found = _guard(edge.get("when", "true"), (*_PATH, "edges", number, "when"), names)
        guards.append(guard)
        findings += found
    if findings:
        return "", findings
    read = [guard for guard in guards if guard is not None]
    propositions = tuple(dict.fromkeys(name for guard in read for name in proposition_order(guard)))
    rows: list[list[str]] = [[] for _ in states]
    aliases: list[str] = []
    for edge, guard in zip(value["edges"], read, strict=True):
        rows[states[str(edge["from"])]].append(f"[{_label(guard, propositions, aliases)}] {states[str(edge['to'])]}")
    accepting = {str(name) for name in value["accepting"]}
    begins = states[str(value.get("initial", value["states"][0]))]
    lines = ["HOA: v1", f"States: {len(states)}", f"Start: {begins}"]
    lines += [" ".join((f"AP: {len(propositions)}", *(f'"{name}"' for name in propositions)))]
    lines += [f"Alias: @{number} {text}" for number, text in enumerate(aliases)]
    lines += ["acc-name: Buchi", "Acceptance: 1 Inf(0)", "--BODY--"]
    for name, number in states.items():
        lines += [f"State: {number}{' {0}' if name in accepting else ''}", *rows[number]]
    return "\n".join([*lines, "--END--", ""]), []


def _unknown_states(value: Mapping[str, Any], states: Iterable[str]) -> Iterator[Finding]:
    """Names in the place of a state that is none."""
    named: list[tuple[Path, Any]] = [(("accepting", i), name) for i, name in enumerate(value["accepting"])]
    named += [(("edges", i, end), edge[end]) for i, edge in enumerate(value["edges"]) for end in ("from", "to")]
    named += [(("initial",), value["initial"])] if "initial" in value else []
    known = tuple(states)
    for path, name in named:
        if str(name) not in known:
            hint = rather(str(name), known, "states")
            yield Finding((*_PATH, *path), f"`{shortened(str(name))}` is none of the automaton's states", hint)


def _guard(text: str, path: Path, names: frozenset[str] | None) -> tuple[Formula | None, Sequence[Finding]]:
    """What an edge reads, and what is wrong with it."""
    try:
        guard = parse_formula(text, names)
    except FormulaSyntaxError as error:
        at = max(0, min(error.column, len(text)) - 1)
        return None, [Finding(path, f"{error.message} (column {error.column})", error.hint, character=at)]
    later = {node.operator for node in postorder(guard)} & TEMPORAL
    if later:
        hint = "an edge reads one letter: write region names with ! & | -> <->"
        return None, [Finding(path, f"`{min(later)}` is about more than one moment", hint)]
    return guard, [] if names is None else [*_unknown_regions(guard, path, names)]


def _unknown_regions(guard: Formula, path: Path, names: frozenset[str]) -> Iterator[Finding]:
    for name in proposition_order(guard):
        if name not in names:
            hint = rather(name, sorted(names), "regions")
            yield Finding(path, f"`{shortened(name)}` is no region", hint)


def _label(guard: Formula, propositions: tuple[str, ...], aliases: list[str]) -> str:
    """A guard as a label expression over the numbers of propositions; what it says twice is an alias."""
    texts: dict[Formula, str] = {}
    for node in postorder(guard):
        parts = [texts[operand] for operand in node.operands]
        if node.operator is Operator.PROPOSITION:
            text = str(propositions.index(node.name))
        elif node.operator is Operator.NOT:
            text = f"!{parts[0]}"
        elif node.operator in _JOINED:
            text = "(" + _JOINED[node.operator].join(parts) + ")"
        elif node.operator is Operator.IMPLIES:
            text = f"(!{parts[0]}|{parts[1]})"
        elif node.operator is Operator.IFF:
            one, other = (f"@{len(aliases)}", f"@{len(aliases) + 1}")
            aliases += parts
            text = f"({one}&{other}|!{one}&!{other})"
        else:
            text = "t" if node.operator is Operator.TRUE else "f"
        texts[node] = text
    return texts[guard]
