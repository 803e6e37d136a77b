"""``mission automaton``: the Büchi automaton of a formula, as a table, as HOA, as Graphviz text or as JSON."""

import json
from argparse import Namespace

from mission.cli.screen import count, out
from mission.logic.automaton import BuchiAutomaton
from mission.logic.hoa import to_hoa
from mission.logic.parser import parse_formula
from mission.logic.translate import translate


def run(arguments: Namespace) -> int:
    """Translate and show."""
    automaton = translate(parse_formula(arguments.formula))
    shown = {"hoa": to_hoa, "dot": to_dot, "json": to_json, "table": to_table}[arguments.form]
    out.out(shown(automaton).rstrip("\n"), highlight=False)
    return 0


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
