"""Examples of each command, as its help shows them."""

from typing import Final

EXAMPLES: Final[dict[str, tuple[tuple[str, str], ...]]] = {
    "check": (
        ("mission check survey.yaml", "every fault, with its line and what to write instead"),
        ("mission check missions/*.yaml -q && echo all well", "for scripts: the exit code alone"),
        ("mission check survey.yaml --connect udpin:0.0.0.0:14550", "may the vehicle there fly it?"),
    ),
    "schema": (
        ("mission schema > mission.schema.json", "for editors, see above"),
        ("mission schema --markdown", "every key with unit, default and example"),
    ),
    "automaton": (
        ("mission automaton 'F (a & F b) & G !c'", "its states and edges"),
        ("mission automaton 'F (a & F b)' --hoa", "for other tools"),
        ("mission automaton 'F G a' '! G F ! a'", "the same language?"),
    ),
    "new": (
        ("mission new", "asks for all it needs"),
        (
            "mission new --from area.kml --visit all --avoid house --out area.yaml",
            "what is drawn, and what it is for",
        ),
        ("mission new --extent 200,150 --altitude 25", "a rectangle to begin with"),
    ),
    "import": (("mission import farm.kml --out farm.yaml", "then answer the questions in farm.yaml"),),
    "plan": (
        ("mission plan survey.yaml --pictures pictures", "the plan, drawn"),
        ("mission plan survey.yaml --altitude 40 --flight-speed 6", "what if?"),
        ("mission plan survey.yaml --out plan.json && mission verify plan.json", "prove it twice"),
    ),
    "simulate": (("mission simulate missions/paper.yaml --off 1,-0.5", "from a metre beside the start"),),
    "verify": (
        ("mission verify plan.json --json", "for programs"),
        ("mission verify flights/survey-20250131-120000/plan.json -v", "all of it"),
        ("mission verify --mission survey.yaml --flight flight.tlog", "whoever flew it"),
    ),
    "export": (
        ("mission export survey.yaml --to survey.plan --at 47.397742,8.545594", "for QGroundControl"),
        ("mission export plan.json --to plan.kml --at 47.397742,8.545594", "for a globe"),
    ),
    "fly": (
        ("mission fly survey.yaml", "with the bundled vehicle, at twenty times real time"),
        ("mission fly survey.yaml --wind 4@270 --flavour px4 --speed 1", "in a west wind, as PX4, in real time"),
        ("mission fly survey.yaml --connect udpin:0.0.0.0:14550", "with the vehicle that calls there"),
        ("mission fly survey.yaml --speed 1 --view --open", "watch it on a page, and hold or land it from there"),
        ("mission fly survey.yaml --json > flight.json", "for programs"),
    ),
    "calibrate": (
        ("mission calibrate survey.yaml --connect tcp:127.0.0.1:5760 --out tube.yaml", "measure ArduPilot's simulator"),
    ),
    "amend": (
        ("mission amend flights/survey-20250131-120000 amended.yaml", "a whole mission"),
        ("echo 'drop K2' | mission amend flights/survey-20250131-120000", "a single change"),
    ),
    "view": (
        ("mission view flights/survey-20250131-120000 --open", "a flight again, with a slider for the time"),
        ("mission view survey.yaml", "a plan, before anything is flown"),
    ),
    "report": (
        ("mission report flights/survey-20250131-120000", "draw it all again"),
        ("mission report flights/survey-*", "errors, distances and battery side by side"),
    ),
}


def examples_of(command: str) -> str:
    """The examples of a command as a part of its help."""
    lines = [f"  {text}\n      {words}" for text, words in EXAMPLES[command]]
    return "\n".join(["examples:", *lines, "", "exit codes: see mission --help"])
