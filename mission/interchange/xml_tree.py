"""XML as a small tree with line numbers; nothing outside of the text is ever loaded, and its size is bounded."""

from dataclasses import dataclass, field
from typing import Final
from xml.sax import SAXParseException
from xml.sax.handler import ContentHandler
from xml.sax.xmlreader import AttributesImpl, Locator

from defusedxml import DefusedXmlException
from defusedxml.sax import parseString

from mission.interchange.features import broken

MOST_ELEMENTS: Final = 500_000
DEEPEST: Final = 50


@dataclass(eq=False, slots=True)
class Element:
    """An element: its name without prefix, its own text, and what is in it."""

    name: str
    line: int
    attributes: dict[str, str]
    children: "list[Element]" = field(default_factory=list)
    text: str = ""

    def all(self, *names: str) -> "list[Element]":
        """The children of these names, in order."""
        return [child for child in self.children if child.name in names]

    def first(self, *path: str) -> "Element | None":
        """The first child's first child, and so on."""
        found: Element | None = self
        for name in path:
            found = next(iter(found.all(name)), None) if found else None
        return found

    def value(self, *path: str) -> str:
        """The text of the element at a path, stripped; empty where there is none."""
        found = self.first(*path)
        return found.text.strip() if found else ""


def xml_tree(content: bytes) -> Element:
    """The root of an XML text.

    Raises:
        SpecError: It is not well-formed, declares entities, nests deeper than 50 or has more than 500,000 elements.
    """
    builder = _Builder()
    try:
        parseString(content, builder)
    except DefusedXmlException as error:
        message = f"the file declares what XML must not load or repeat: {type(error).__name__}"
        raise broken(message, "save it without document type and entities", line=builder.line) from None
    except SAXParseException as error:
        line, column = error.getLineNumber() or 0, (error.getColumnNumber() or 0) + 1
        message = f"this is not well-formed XML: {error.getMessage()}"
        raise broken(message, "the file may have been cut off", line=line, column=column) from None
    except (ValueError, LookupError) as error:  # an encoding that is unknown, or none of its text
        raise broken(f"this is not XML: {error}", "save the file as UTF-8", line=builder.line) from None
    return builder.root


class _Builder(ContentHandler):
    def __init__(self) -> None:
        super().__init__()
        self.root = Element("", 0, {})
        self._open = [self.root]
        self._texts: list[list[str]] = [[]]
        self._count = 0
        self._locator: Locator | None = None

    @property
    def line(self) -> int:
        """Where the parser is."""
        return (self._locator.getLineNumber() or 0) if self._locator else 0

    def setDocumentLocator(self, locator: Locator) -> None:  # noqa: N802 - as SAX calls it
        self._locator = locator

    def startElement(self, name: str, attrs: AttributesImpl) -> None:  # noqa: N802 - as SAX calls it
        self._count += 1
        if self._count > MOST_ELEMENTS or len(self._open) > DEEPEST:
            bound = f"has more than {MOST_ELEMENTS} elements" if self._count > MOST_ELEMENTS else "nests too deeply"
            raise broken(f"the file {bound}", "save what the mission needs alone", line=self.line)
        element = Element(name.rpartition(":")[2], self.line, dict(attrs.items()))
        self._open[-1].children.append(element)
        self._open.append(element)
        self._texts.append([])

    def endElement(self, _: str) -> None:  # noqa: N802 - as SAX calls it
        self._open.pop().text = "".join(self._texts.pop())

    def characters(self, content: str) -> None:
        self._texts[-1].append(content)
