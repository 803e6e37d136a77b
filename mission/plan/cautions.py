"""What the writer of a mission that can be flown may not have meant."""

from collections.abc import Iterator

from mission.errors import AutomatonSizeError
from mission.logic.automaton import compile_to_alphabet
from mission.logic.formula import Formula, Operator, negation, postorder
from mission.logic.translate import translate
from mission.logic.word import Letter
from mission.plan.diagnosis import conjuncts
from mission.plan.missing_letters import violated_by_first
from mission.spec.model import Semantics


def cautions(formula: Formula, letters: tuple[Letter, ...], start: int, semantics: Semantics) -> tuple[str, ...]:
    """Warnings for a formula that a plan satisfies, conjunct by conjunct.

    A conjunct already holds at the start where every word over the labels of the map that begins with the start's
    satisfies it, and asks nothing where every word does. One with ``X`` may mean another thing on another mesh.

    Args:
        formula: The specification.
        letters: The observations of the map.
        start: Number of the start triangle's letter.
        semantics: Whether that letter is read.
    """
    return tuple(
        warning for conjunct in conjuncts(formula) for warning in _cautions(conjunct, letters, start, semantics)
    )


def _cautions(conjunct: Formula, letters: tuple[Letter, ...], start: int, semantics: Semantics) -> Iterator[str]:
    if any(node.operator is Operator.NEXT for node in postorder(conjunct)):
        yield (
            f"`{conjunct}` may depend on the mesh: X speaks of the next triangle on the way, "
            "or of the same one where the vehicle stays"
        )
    try:
        refutation = compile_to_alphabet(translate(negation(conjunct)), letters)
    except AutomatonSizeError:
        return
    if all(violated_by_first(refutation, letter) for letter in range(len(letters))):
        yield f"`{conjunct}` asks nothing: every flight on this map satisfies it"
    elif semantics is Semantics.STANDARD and violated_by_first(refutation, start):
        where = ", ".join(sorted(letters[start])) or "no region"
        yield f"`{conjunct}` already holds where the flight starts ({where}): it asks nothing of the rest"
