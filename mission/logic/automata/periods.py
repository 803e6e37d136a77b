"""Whether an automaton counts how often a word is repeated.

Languages of linear temporal logic are *counter-free*: however often a word has been repeated already, once more makes
no difference (McNaughton and Papert, "Counter-free automata", 1971). In a deterministic automaton whose states are what
can remain of the language, a loop over letters therefore comes to one state and stays there. Other automata, such as
one that meets its acceptance sets in turn, may take several rounds of a loop for one of their own.
"""

from typing import Final

import numpy as np

from mission.logic.automata.rabin import DEAD, Rabin

MAX_ACTIONS: Final = 2_000
"""Functions from states to states that are looked at."""


def counts_rounds(automaton: Rabin) -> bool:
    """Whether some word, repeated, leads through several states again and again; True if that is not found out."""
    letters = np.unique(np.vstack((automaton.targets, np.full(automaton.targets.shape[1], DEAD))), axis=1).T
    queue = list(letters)
    known = {action.tobytes() for action in queue}
    for action in queue:
        if _cycles(action):
            return True
        for letter in letters:
            longer = letter[action]  # the last place is that of no state, which -1 is, too
            key = longer.tobytes()
            if key not in known:
                known.add(key)
                queue.append(longer)
        if len(queue) > MAX_ACTIONS:
            return True
    return False


def _cycles(action: "np.ndarray[tuple[int], np.dtype[np.int64]]") -> bool:
    onward = action
    for _ in range(len(action).bit_length()):
        onward = onward[onward]
    return bool((action[onward] != onward).any())
