"""Where in the file a finding stands."""

from mission.errors import Fault
from mission.spec.finding import Finding, Path, dotted
from mission.spec.nodes import Mapping, Node, Scalar, Sequence, Table
from mission.spec.yaml_errors import LINE_BREAK


def placed(finding: Finding, tree: Node, text: str) -> Fault:
    """The finding as a fault, with line and column of the value (or the key) that it speaks of.

    A path that leads nowhere gets the place of what contains it.
    """
    node, key = _found(finding.path, tree)
    at: Node = key if key and (finding.at_key or not _has_text(node)) else node
    line, column = at.line, at.column
    if finding.character is not None and isinstance(node, Scalar):
        line, column = _character_place(node, finding.character, LINE_BREAK.split(text))
    return Fault(line, column, dotted(finding.path), finding.message, finding.hint)


def _found(path: Path, tree: Node) -> tuple[Node, Scalar | None]:
    """The node at a path, or as far as it leads; and the last key on the way."""
    node: Node = tree
    key: Scalar | None = None
    for step in path:
        if isinstance(node, Sequence | Table) and isinstance(step, int) and step < len(node.items):
            node, key = node.items[step], None
        elif isinstance(node, Mapping) and step in node.values:
            key, node = node.keys[str(step)], node.values[str(step)]
        else:
            break
    return node, key


def _has_text(node: Node) -> bool:
    """Whether there is something to point at: the value of `key:` alone has no text."""
    return not isinstance(node, Scalar) or bool(node.text) or not node.plain


def _character_place(node: Scalar, character: int, lines: list[str]) -> tuple[int, int]:
    """Line and column of a character of a text; of the text's begin where escapes or folding hide it."""
    row = node.line - 1
    if node.style in ("|", ">"):
        # A block begins below its indicator; its lines stand there as they are, but for the indentation.
        before = node.text[:character].split("\n")
        content = node.text.split("\n")[len(before) - 1]
        at = row + len(before)
        if node.style == "|" and at < len(lines) and lines[at].endswith(content):
            return at + 1, len(lines[at]) - len(content) + len(before[-1]) + 1
        return node.line, node.column
    begin = node.column - 1 + (0 if node.plain else 1)
    if lines[row][begin : begin + len(node.text)] == node.text:
        return node.line, begin + character + 1
    return node.line, node.column
