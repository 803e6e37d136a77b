"""``mission automaton``: the Büchi automaton of a formula, as a table, HOA, Graphviz text or JSON, and as a picture."""

import json
from argparse import Namespace
from pathlib import Path

from mission.cli.inputs import write_named
from mission.cli.screen import count, out
from mission.errors import Fault, SpecError
from mission.logic.automata.automaton import BuchiAutomaton
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula
from mission.logic.hoa.text import to_hoa

_PICTURES = (".pdf", ".png", ".svg")


def run(arguments: Namespace) -> int:
    """Translate and show; a picture is written first, whoever reads the rest."""
    picture = None if arguments.picture is None else _picture_file(arguments.picture)
    formula = parse_formula(arguments.formula)
    if picture is not None:
        _draw(formula, picture)
    if arguments.form == "generalised":
        _print(to_hoa(translate_generalised(formula)))
    else:
        shown = {"hoa": to_hoa, "dot": to_dot, "json": to_json, "table": to_table}[arguments.form]
        _print(shown(translate(formula)))
    return 0


def _print(text: str) -> None:
    out.out(text.rstrip("\n"), highlight=False)


def _picture_file(name: str) -> Path:
    file = Path(name)
    if file.suffix.lower() not in _PICTURES:
        kinds = f"{', '.join(_PICTURES[:-1])} or {_PICTURES[-1]}"
        message = f"{name!r} does not say which kind of picture to draw"
        raise SpecError((Fault(0, 0, "--picture", message, f"give the file a name that ends in {kinds}"),))
    return file


def _draw(formula: Formula, file: Path) -> None:
    # Drawing is loaded when it is asked for.
    from mission.report.figures.automaton import automaton_of_formula  # noqa: PLC0415
    from mission.report.figures.canvas import to_pdf, to_png, to_svg  # noqa: PLC0415

    written = {".png": to_png, ".svg": to_svg, ".pdf": to_pdf}[file.suffix.lower()]
    write_named("--picture", file, written(automaton_of_formula(translate(formula), str(formula))))


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
