"""The automaton that a mission file names: its content as a value, and what may be wrong with it."""

from collections.abc import Iterable

from mission.errors import Fault, SpecError
from mission.logic.hoa.text import parse_generalised
from mission.spec.finding import Finding, Path, rather, shortened
from mission.spec.model import NamedAutomaton

AUTOMATON: Path = ("mission", "automaton")


def named_automaton(
    file: str, content: bytes, regions: Iterable[str] | None
) -> tuple[NamedAutomaton | None, list[Finding]]:
    """The automaton of a file, None where it is none, and what is wrong with it.

    Args:
        file: The file as the mission names it, for messages.
        content: Its bytes.
        regions: Names of the regions; None where they are not known.
    """
    try:
        text = content.decode("utf-8-sig")
        automaton = parse_generalised(text)
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        message = f"{shortened(file)}, line {line}: the byte 0x{content[error.start]:02x} is not UTF-8"
        return None, [Finding(AUTOMATON, message, "name a file in the Hanoi Omega-Automata format")]
    except SpecError as error:
        return None, [_unreadable(file, fault) for fault in error.faults]
    findings = [] if regions is None else list(_unknown(file, automaton.propositions, frozenset(regions)))
    return NamedAutomaton(file, text, automaton), findings


def _unreadable(file: str, fault: Fault) -> Finding:
    message = f"{shortened(file)}, line {fault.line}, column {fault.column}: {fault.message}"
    hint = f"there, {fault.hint}" if fault.hint else "correct that file; the format is described at adl.github.io/hoaf"
    return Finding(AUTOMATON, message, hint)


def _unknown(file: str, propositions: Iterable[str], regions: frozenset[str]) -> Iterable[Finding]:
    for name in propositions:
        if name not in regions:
            hint = rather(name, sorted(regions), "regions")
            message = f"the automaton in {shortened(file)} speaks of `{shortened(name)}`, which is no region"
            yield Finding(AUTOMATON, message, hint)
