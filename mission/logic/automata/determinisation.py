"""From nondeterministic Büchi automata to deterministic parity automata.

A state is a tree whose root holds the states that the runs may be in. What comes from accepting states becomes a new
child of its node; a state that an older sibling has, too, is taken out of the younger one. When the children of a node
hold all that the node holds, each of its runs has met an accepting state since the last time: the children are taken
away, and the node is *done* once more. A word is accepted if some node stays for ever and is done again and again
(Safra, "On the complexity of omega-automata", 1988). Nodes are numbered by age, and close up when older ones go, so
that the least number that is done again and again, and no longer loses an older one, decides (Piterman, "From
nondeterministic Büchi and Streett automata to deterministic parity automata", 2007; with ordered trees instead of names
Schewe, "Tighter bounds for the determinisation of Büchi automata", 2009).
"""

from dataclasses import dataclass

from mission.logic.automata.diagrams import TooLargeError
from mission.logic.automata.lettered import Lettered, bits_of

_Tree = tuple[tuple[int, int], ...]
"""Nodes from old to young: the number of the parent, -1 of the root, and the bits of the states. Parents are older
than their children; the children of a node have no state in common, and together fewer than the node."""


@dataclass(frozen=True)
class ParityAutomaton:
    """A deterministic and complete automaton; state 0 is initial.

    A word is accepted if and only if the least priority that its run has again and again is even.

    Attributes:
        moves: For each state and letter, the state entered and the priority of the transition, from 1 on.
    """

    moves: tuple[tuple[tuple[int, int], ...], ...]


def determinised(automaton: Lettered, letters: int, limit: int) -> ParityAutomaton:
    """A parity automaton of the words that a Büchi automaton accepts.

    Args:
        automaton: With one acceptance set, in which all moves of a state are or none is.
        letters: How many there are.
        limit: Number of states at which to give up.

    Raises:
        TooLargeError: The limit was passed.
    """
    trees = _Trees(automaton)
    root: _Tree = ((-1, bits_of(automaton.initial)),)
    number = {root: 0}
    queue = [root]
    rows = []
    for tree in queue:
        row = []
        for letter in range(letters):
            following, priority = trees.after(tree, letter)
            if following not in number:
                number[following] = len(queue)
                queue.append(following)
            row.append((number[following], priority))
        rows.append(tuple(row))
        if len(queue) > limit:
            raise TooLargeError
    return ParityAutomaton(tuple(rows))


class _Trees:
    """The steps from tree to tree."""

    def __init__(self, automaton: Lettered) -> None:
        self._post = automaton.posts()
        self._accepting = automaton.accepting
        self._most = automaton.size  # nodes of a tree: each has a state that none of its children has

    def after(self, tree: _Tree, letter: int) -> tuple[_Tree, int]:
        """The tree that follows, and the priority of the step."""
        nodes = [(parent, self._post(states, letter)) for parent, states in tree]
        nodes += [(index, self._post(states & self._accepting, letter)) for index, (_, states) in enumerate(tree)]
        held = [0] * len(nodes)
        shared = [0] * len(nodes)  # what the children of each node hold together
        for index, (parent, found) in enumerate(nodes):
            held[index] = found
            if parent >= 0:
                held[index] &= held[parent] & ~shared[parent]
                shared[parent] |= held[index]
        number: dict[int, int] = {}
        kept: list[tuple[int, int]] = []
        for index, (parent, _) in enumerate(nodes):
            if held[index] and (parent < 0 or (parent in number and held[parent] != shared[parent])):
                number[index] = len(kept)
                kept.append((number.get(parent, -1), held[index]))
        gone = next((index for index in range(len(tree)) if index not in number), self._most)
        done = next((index for index in number if held[index] == shared[index]), self._most)
        return tuple(kept), 2 * done + 2 if done < gone else 2 * gone + 1
