"""Figure 4: the Büchi automaton of a formula, states in layers from the initial ones to the accepting ones."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mission.errors import AutomatonSizeError
from mission.geometry.arrays import FloatArray
from mission.logic.automata.automaton import BuchiAutomaton, Edge
from mission.plan import FlightPlan
from mission.report.figures.arrows import draw_arrows
from mission.report.figures.automaton_layout import DISC_PT, Arrangement, Part, arranged
from mission.report.figures.canvas import (
    NOTE_PT,
    POINTS_PER_INCH,
    TITLE_PT,
    about,
    drawing,
    head_pt,
    new_figure,
    text_size_em,
    titled,
)
from mission.report.figures.guard_text import in_lines, keyed, shortened, written
from mission.report.palette import BLACK, BLUE, QUIET, WHITE
from mission.spec.model import Semantics

MOST_STATES, MOST_EDGES = 30, 80
MOST_STATES_IN_FULL = 8
MOST_EDGES_IN_FULL = 24
GUARD_PT, SMALL_GUARD_PT = 10.0, 8.5
LEAST_WIDTH_PT = 470.0
MARGIN_PT = 26.0
TEXT_MARGIN_PT = 12.0
KEY_PT, KEY_LINE_PT, KEY_GAP_PT = 9.0, 14.0, 18.0
ON_PIXELS = 1.05  # how much wider long lines become when each letter starts on a pixel
WIDEST_PT, HIGHEST_PT = 1100.0, 1300.0  # of a picture that is still read when it is printed on a page
ACCEPTING_FILL = "#CCEBE3"  # GREEN at a fifth


def automaton(plan: FlightPlan) -> Figure:
    """The automaton with its guards; of one with more than 30 states, the part that the run goes through.

    Those of the parts of a specification, where one of the whole would be too large, stand side by side.

    Guards are written in full where they find room, else as short as the labels of the domain allow, else by a key.
    """
    machine = plan.shown_automaton
    part, arrangement = shown_part(plan)
    name = "Automaton" if plan.shown_parts == 1 else f"Automata of {plan.shown_parts} parts"
    title = f"{name}: {machine.size} states, {machine.edge_count} edges"
    return _drawn(machine, part, arrangement, title, plan)


def shown_part(plan: FlightPlan) -> tuple[Part, Arrangement]:
    """What is shown of a plan's automaton, and where it stands."""
    return _first_that_fits(plan.shown_automaton, _parts(plan))


def automaton_of_formula(machine: BuchiAutomaton, formula: str) -> Figure:
    """The whole automaton of a formula, with guards in full where they find room, else by a key.

    Raises:
        AutomatonSizeError: It is too large to be read in a picture.
    """
    if machine.size > MOST_STATES:
        raise _unreadable(f"an automaton of {machine.size} states cannot be read in a picture, {MOST_STATES} can be")
    if machine.edge_count > MOST_EDGES:
        raise _unreadable(
            f"an automaton of {machine.edge_count} edges cannot be read in a picture, {MOST_EDGES} can be"
        )
    part, arrangement = _first_that_fits(machine, _whole(machine, formula))
    kind = "deterministic" if machine.deterministic else "nondeterministic"
    numbers = f"{_count(machine.size, 'state')}, {_count(machine.edge_count, 'edge')}"
    figure = _drawn(machine, part, arrangement, f"Automaton: {numbers}, {kind}")
    width_pt, height_pt = POINTS_PER_INCH * figure.get_size_inches()
    if width_pt > WIDEST_PT or height_pt > HIGHEST_PT:
        raise _unreadable(f"an automaton of {machine.edge_count} edges cannot be read in a picture")
    return figure


def _unreadable(reason: str) -> AutomatonSizeError:
    return AutomatonSizeError(f"{reason}; print it as a table, or with --dot for a drawing program")


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _first_that_fits(machine: BuchiAutomaton, parts: Iterable[Part]) -> tuple[Part, Arrangement]:
    """The first part whose guards find room, or the last one."""
    for part in parts:
        roots = [part.states.index(state) for state in machine.initial if state in part.states]
        size_pt = GUARD_PT if len(part.states) <= MOST_STATES_IN_FULL else SMALL_GUARD_PT
        arrangement = arranged(part, roots, size_pt)
        if np.all(arrangement.corners[1] - arrangement.corners[0] <= (WIDEST_PT, HIGHEST_PT)):
            break
    return part, arrangement


def _whole(machine: BuchiAutomaton, formula: str) -> Iterator[Part]:
    """Ways to show an automaton that no domain belongs to."""
    states, guards = tuple(range(machine.size)), [edge.guard for edge in machine.edges]
    note = in_lines(formula)
    if len(guards) <= MOST_EDGES_IN_FULL and len(states) <= MOST_STATES_IN_FULL:
        yield Part(states, machine.edges, frozenset(), tuple(map(written, guards)), (), note)
    names, key = keyed(guards)
    yield Part(states, machine.edges, frozenset(), tuple(names), tuple(key), note)


def _drawn(
    machine: BuchiAutomaton, part: Part, arrangement: Arrangement, title: str, plan: FlightPlan | None = None
) -> Figure:
    with drawing():
        figure, axes = _canvas(arrangement.corners, title, part, plan)
        for idle, colour in ((False, BLACK), (True, QUIET)):
            chosen = [curve for k, curve in enumerate(arrangement.curves) if (k in part.idle) is idle]
            draw_arrows(axes, chosen, colour=colour, width=1.0, head=8.0, dashed=idle)
        _draw_states(axes, machine, part.states, arrangement)
        for k, ((x, y), text) in enumerate(zip(arrangement.labels.tolist(), part.texts, strict=True)):
            axes.text(
                x,
                y,
                text,
                fontsize=arrangement.size_pt,
                color=QUIET if k in part.idle else BLUE,
                ha="center",
                va="center",
                linespacing=1.0,
                zorder=4,
                gid="guard",
                bbox={"facecolor": WHITE, "linewidth": 0, "boxstyle": "square,pad=0.06"},
            )
    return figure


def _parts(plan: FlightPlan) -> Iterator[Part]:
    """Ways to show the plan's automaton on one page, the most complete first."""
    machine = plan.shown_automaton
    states, notes = tuple(range(machine.size)), []
    if machine.size > MOST_STATES:
        states = tuple(sorted(states_along(plan)[:MOST_STATES]))
        notes = [f"{len(states)} of {machine.size} states: those along the run."]
    edges = [edge for edge in machine.edges if edge.source in states and edge.target in states]
    idle = frozenset(k for k, edge in enumerate(edges) if not _takes_any(edge, plan.labelling.letters))
    if len(edges) <= MOST_EDGES_IN_FULL and len(states) <= MOST_STATES_IN_FULL:
        more = ["Dashed: edges that no label of the domain can take."] if idle else []
        texts = tuple(written(edge.guard) for edge in edges)
        yield Part(states, tuple(edges), idle, texts, (), " ".join(notes + more))
    restricted = {region.name for region in plan.spec.regions if region.forbidden}
    met = [letter for letter in plan.labelling.letters if not letter & restricted]
    taken = [edge for edge in edges if _takes_any(edge, met)]
    reached = _reached(machine.initial, taken)
    unreached = [state for state in states if state not in reached]
    states = tuple(state for state in states if state in reached)
    left_out = len(edges) - len(taken)
    taken = [edge for edge in taken if edge.source in reached]
    guards = [shortened(edge.guard, met) for edge in taken]
    if any(guard != edge.guard for guard, edge in zip(guards, taken, strict=True)):
        notes.append("Guards are cut to what tells the labels outside restricted regions apart.")
    if left_out:
        lost = f", and {_count(len(unreached), 'state')} that nothing else leads to" if unreached else ""
        notes.append(f"{_count(left_out, 'edge')} that none of these labels can take are left out{lost}.")
    note = "\n".join(notes)
    yield Part(states, tuple(taken), frozenset(), tuple(map(written, guards)), (), note)
    names, key = keyed(guards)
    yield Part(states, tuple(taken), frozenset(), tuple(names), tuple(key), note)


def _reached(initial: Iterable[int], edges: Sequence[Edge]) -> set[int]:
    """The states that edges lead to from the initial ones."""
    reached, waiting = set(initial), list(initial)
    while waiting:
        source = waiting.pop()
        found = {edge.target for edge in edges if edge.source == source} - reached
        reached |= found
        waiting += sorted(found)
    return reached


def _takes_any(edge: Edge, letters: Sequence[frozenset[str]]) -> bool:
    return any(edge.guard.allows(letter) for letter in letters)


def states_along(plan: FlightPlan) -> list[int]:
    """States that some accepting reading of the run's word goes through, in the order in which they are met.

    The word is that of the run's triangles; where the automaton has several readings, all states count from which the
    end of the second round of the loop can still be reached.
    """
    machine = plan.shown_automaton
    triangles = [*plan.run.prefix, *plan.run.suffix, *plan.run.suffix]
    letters = [plan.labelling.label(triangle) for triangle in triangles]
    if plan.spec.semantics is Semantics.PAPER:
        letters = letters[1:]
    reached = [frozenset(machine.initial)]
    for letter in letters:
        steps = (edge.target for state in reached[-1] for edge in machine.outgoing[state] if edge.guard.allows(letter))
        reached.append(frozenset(steps))
    useful = reached[-1]
    kept = [useful]
    for states, letter in zip(reached[-2::-1], letters[::-1], strict=True):
        useful = frozenset(
            state
            for state in states
            if any(edge.target in useful and edge.guard.allows(letter) for edge in machine.outgoing[state])
        )
        kept.append(useful)
    return list(dict.fromkeys(state for states in kept[::-1] for state in sorted(states)))


def _canvas(corners: FloatArray, title: str, part: Part, plan: FlightPlan | None) -> tuple[Figure, Axes]:
    """A figure as large as what it shows, with axes in points that cover it."""
    (west, south), (east, north) = corners
    key_width = KEY_PT * max((text_size_em(line)[0] for line in part.key), default=0.0)
    words = max(key_width, NOTE_PT * text_size_em(part.note)[0], TITLE_PT * text_size_em(title, "bold")[0])
    width = max(LEAST_WIDTH_PT, east - west + 2 * MARGIN_PT, ON_PIXELS * words + 2 * TEXT_MARGIN_PT)
    west = 0.5 * (west + east - width)
    rows = _key_rows(part.key, width - 2 * TEXT_MARGIN_PT, key_width)
    below = 30.0 + KEY_LINE_PT * rows + 13.0 * part.note.count("\n") + (8.0 if part.key else 0.0)
    about_it = about(plan, width) if plan else ""
    north, south = north + head_pt(about_it) + 12.0, south - below
    figure = new_figure(width, north - south)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(west, west + width), ylim=(south, north))
    axes.set_axis_off()
    titled(figure, title, part.note, about_it)
    for k, line in enumerate(part.key):
        x = west + TEXT_MARGIN_PT + (key_width + KEY_GAP_PT) * (k // rows)
        y = south + below - KEY_LINE_PT * (k % rows + 1)
        axes.text(x, y, line, fontsize=KEY_PT, va="bottom", color=BLUE, gid="key")
    return figure, axes


def _key_rows(key: Sequence[str], width: float, line_width: float) -> int:
    """How many lines a column of the key has; entries of several lines stand in one column."""
    columns = 1
    if key and not any(line.startswith(" ") for line in key):
        columns = max(1, int((width + KEY_GAP_PT) // (line_width + KEY_GAP_PT)))
    return -(-len(key) // columns)


def _draw_states(axes: Axes, machine: BuchiAutomaton, states: Sequence[int], arrangement: Arrangement) -> None:
    nodes = arrangement.nodes
    axes.scatter(
        nodes[:, 0],
        nodes[:, 1],
        s=(2 * DISC_PT) ** 2,
        facecolor=WHITE,
        edgecolor=BLACK,
        linewidth=1.4,
        zorder=3,
        gid="states",
    )
    accepting = nodes[[k for k, state in enumerate(states) if state in machine.accepting]]
    axes.scatter(
        accepting[:, 0],
        accepting[:, 1],
        s=(2 * DISC_PT - 7) ** 2,
        facecolor=ACCEPTING_FILL,
        edgecolor=BLACK,
        linewidth=1.4,
        zorder=3.1,
        gid="accepting",
    )
    for state, (x, y) in zip(states, nodes.tolist(), strict=True):
        axes.text(
            x,
            y,
            f"q{state}",
            fontsize=min(10.5, 1.7 * DISC_PT / text_size_em(f"q{state}")[0]),
            ha="center",
            va="center_baseline",
            zorder=4,
            gid="state",
        )
    draw_arrows(axes, arrangement.starts, colour=BLACK, width=1.8, head=9.0)
