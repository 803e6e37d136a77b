"""Automata in the Hanoi Omega-Automata format, version 1: written, and read as Büchi automata.

Source: the format's own description, https://adl.github.io/hoaf/.
"""

from mission.logic.automata.automaton import BuchiAutomaton, GeneralisedBuchi
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.automata.guards import Guard
from mission.logic.hoa.reader import Reader


def to_hoa(automaton: BuchiAutomaton | GeneralisedBuchi) -> str:
    """The automaton as text, with explicit labels; states keep their numbers."""
    lines = ["HOA: v1", f"States: {automaton.size}", *(f"Start: {state}" for state in automaton.initial)]
    lines.append(" ".join((f"AP: {len(automaton.propositions)}", *(f'"{name}"' for name in automaton.propositions))))
    rows: list[list[str]] = [[] for _ in range(automaton.size)]
    if isinstance(automaton, BuchiAutomaton):
        lines += ["acc-name: Buchi", "Acceptance: 1 Inf(0)"]
        properties = ["trans-labels", "explicit-labels", "state-acc", "no-univ-branch"]
        for edge in automaton.edges:
            rows[edge.source].append(f"[{_label(edge.guard)}] {edge.target}")
        heads = [f"State: {state}" + " {0}" * (state in automaton.accepting) for state in range(automaton.size)]
    else:
        lines.append(f"acc-name: generalized-Buchi {automaton.sets}")
        condition = "&".join(f"Inf({index})" for index in range(automaton.sets)) or "t"
        lines.append(f"Acceptance: {automaton.sets} {condition}")
        properties = ["trans-labels", "explicit-labels", "trans-acc", "no-univ-branch"]
        for marked in automaton.edges:
            marks = f" {{{' '.join(map(str, marked.marks))}}}" if marked.marks else ""
            rows[marked.source].append(f"[{_label(marked.guard)}] {marked.target}{marks}")
        heads = [f"State: {state}" for state in range(automaton.size)]
    properties += ["deterministic"] * automaton.deterministic + ["complete"] * automaton.complete
    lines += ["properties: " + " ".join(properties), "--BODY--"]
    for head, row in zip(heads, rows, strict=True):
        lines += [head, *row]
    return "\n".join([*lines, "--END--", ""])


def _label(guard: Guard) -> str:
    cubes = []
    for holds, fails in guard.cubes:
        literals = [
            f"{'' if holds >> bit & 1 else '!'}{bit}"
            for bit in range(len(guard.propositions))
            if (holds | fails) >> bit & 1
        ]
        cubes.append("&".join(literals) or "t")
    return " | ".join(cubes)


def parse_hoa(text: str) -> BuchiAutomaton:
    """Read an automaton as one with accepting states.

    Where the file has Büchi acceptance on states, the states keep their numbers; any other automaton is brought to
    that form first, and loses states that are not needed.

    Raises:
        SpecError: The text is no such automaton, or one of a kind that is refused; with line, column and reason.
        AutomatonSizeError: It is too large to be brought to that form.
    """
    return with_accepting_states(parse_generalised(text))


def parse_generalised(text: str) -> GeneralisedBuchi:
    """Read an automaton as one with marked transitions; its states keep their numbers.

    Raises:
        SpecError: As ``parse_hoa``.
    """
    return Reader(text).read()
