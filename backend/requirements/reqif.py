"""Reads requirements from ReqIF files, and writes them as one. Source: OMG, Requirements Interchange Format 1.2.

A file is stored byte by byte, so it is written back as it was; this module only finds ids and texts in it. A document
type declaration is refused before anything in it is read: ReqIF has none, and entities are declared there.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime
from typing import NamedTuple
from xml.etree import ElementTree as Xml

from backend.requirements.rich import plain

NAMESPACE = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd"
DEEPEST = 100
"""Levels of elements; the hierarchy of a specification nests two for each of its own."""
MOST_ELEMENTS = 400_000
MOST_ATTRIBUTES, LONGEST_NAME = 64, 200
"""XML attributes of an element, and characters of a name; the standard's elements have at most 10, of at most 40."""

IDS = ("ReqIF.ForeignID", "ID", "UID", "Object Identifier", "Identifier", "Requirement ID")
"""Attributes that hold the id, the first that an object has, in any case; without one, the object's IDENTIFIER."""
OWN = "IDENTIFIER"
"""Given as the attribute of the id: the object's own, which the standard requires to be unique."""
TEXTS = (
    "ReqIF.Text",
    "Text",
    "Object Text",
    "Description",
    "Statement",
    "ReqIF.Description",
    "ReqIF.Name",
    "Name",
    "Title",
)
"""Attributes that hold the text, the first that an object has; without one, its DESC or LONG-NAME."""
HEADING = "reqif.chaptername"
"""An object that has this attribute and no text is a heading."""

FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot contain."""


class Read(NamedTuple):
    """A requirement of a file: its other attributes as text by name."""

    id: str
    text: str
    attributes: dict[str, str]


class CannotRead(ValueError):
    """The file is no ReqIF, or not an acceptable one; the message states why and what to do."""


class _Builder(Xml.TreeBuilder):
    """Builds the tree without namespaces in the tags, within limits."""

    def __init__(self) -> None:
        super().__init__()
        self.depth = self.elements = 0

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        """Refuse a document type declaration, before its entities are declared."""
        raise CannotRead("the file has a document type declaration (<!DOCTYPE), which ReqIF does not allow: remove it")

    def start(self, tag: str, attrs: dict[str, str]) -> Xml.Element:
        self.depth += 1
        self.elements += 1
        if self.depth > DEEPEST:
            raise CannotRead(f"the file nests elements deeper than {DEEPEST} levels")
        if self.elements > MOST_ELEMENTS:
            raise CannotRead(f"the file has more than {MOST_ELEMENTS:,} elements: export fewer objects at a time")
        if len(attrs) > MOST_ATTRIBUTES:
            raise CannotRead(f"an element of the file has more than {MOST_ATTRIBUTES} XML attributes")
        name = tag.rpartition("}")[2]
        if max(map(len, (name, *attrs))) > LONGEST_NAME:
            raise CannotRead(
                f"the file has the name of an element or attribute with more than {LONGEST_NAME} characters"
            )
        return super().start(name, attrs)

    def end(self, tag: str) -> Xml.Element:
        self.depth -= 1
        return super().end(tag.rpartition("}")[2])


def parse(content: bytes) -> Xml.Element:
    """The root element; raises `CannotRead`."""
    if content[:2] == b"PK":
        raise CannotRead("this is an archive (.reqifz): unpack it, and import the .reqif file in it")
    try:
        root = Xml.fromstring(content, Xml.XMLParser(target=_Builder()))
    except CannotRead:
        raise
    except (Xml.ParseError, LookupError, ValueError) as error:  # an unknown encoding is a LookupError or a ValueError
        raise CannotRead(f"the file is not readable as XML: {error}") from None
    if root.tag != "REQ-IF":
        raise CannotRead(f"the file is no ReqIF: its root element is {root.tag[:60]}, expected REQ-IF")
    return root


def read(content: bytes, id_name: str = "", text_name: str = "") -> tuple[list[Read], int]:
    """The requirements of a file, in its order, and how many objects without a text were skipped.

    id_name, text_name: the attributes to use, instead of `IDS` and `TEXTS`; `OWN` unless an attribute is called that.
    Raises `CannotRead`.
    """
    root = parse(content)
    names: dict[str, str] = {}
    for group in root.iter("SPEC-ATTRIBUTES"):  # types have attributes of the same name, an object has one type
        defined = {_key(e): e.get("LONG-NAME") or _key(e) for e in group if _key(e)}
        names.update(zip(defined, numbered(defined.values()), strict=True))
    words = {_key(e): e.get("LONG-NAME", "") for e in root.iter("ENUM-VALUE")}
    by_own = id_name == OWN and OWN.lower() not in {name.lower() for name in names.values()}
    found, skipped = [], 0
    used: dict[str, None] = {}
    for thing in root.iter("SPEC-OBJECT"):
        attributes = list(_values(thing, names, words))
        values = dict(zip(numbered(name for name, _ in attributes), (value for _, value in attributes), strict=True))
        used.update(dict.fromkeys(values))
        text = _text(thing, values, text_name)
        if not text[1].strip():
            skipped += 1
            continue
        key = ("", "") if by_own else _first(values, (id_name,) if id_name else IDS)
        own = key[1].strip() or (_key(thing) if by_own or not id_name else "")
        if not own:
            raise CannotRead(f"an object has no value of the attribute {id_name[:60]!r}; {_listed(names.values())}")
        rest = {name: value for name, value in values.items() if name not in (key[0], text[0]) and value}
        found.append(Read(own, text[1].strip(), rest))
    if not found:
        raise CannotRead(
            f"no object of the file has a text ({skipped} objects): name the attribute that holds it; "
            f"{_listed(names.values() or used)}"
        )
    return found, skipped


def numbered(names: Iterable[str]) -> list[str]:
    """The names in their order; one that occurs again is `Note (2)`, so that every value has a name of its own."""
    listed = [name[:LONGEST_NAME] for name in names]
    taken, found, times = set(listed), [], Counter[str]()
    for name in listed:
        times[name] += 1
        unique = name
        if name and times[name] > 1:
            while (unique := f"{name[: LONGEST_NAME - 10]} ({times[name]})") in taken:
                times[name] += 1
        taken.add(unique)
        found.append(unique)
    return found


def _key(element: Xml.Element) -> str:
    return element.get("IDENTIFIER", "").strip()


def _values(thing: Xml.Element, names: dict[str, str], words: dict[str, str]) -> Iterator[tuple[str, str]]:
    """The values of an object by the names of their attributes, or by their identifiers."""
    for value in thing.findall("./VALUES/*"):
        definition = value.find("./DEFINITION/*")
        key = (definition.text or "").strip() if definition is not None else ""
        name = names.get(key) or key
        if not name:
            continue
        if value.tag == "ATTRIBUTE-VALUE-XHTML":
            inner = value.find("THE-VALUE")
            yield name, plain(inner) if inner is not None else ""
        elif value.tag == "ATTRIBUTE-VALUE-ENUMERATION":
            chosen = [(ref.text or "").strip() for ref in value.findall("./VALUES/ENUM-VALUE-REF")]
            yield name, ", ".join(words.get(one) or one for one in chosen)
        else:
            yield name, value.get("THE-VALUE", "")


def _text(thing: Xml.Element, values: dict[str, str], text_name: str) -> tuple[str, str]:
    """The attribute that holds the text, and the text; both empty for a heading."""
    found = _first(values, (text_name,) if text_name else TEXTS)
    heading = any(name.lower() == HEADING and value for name, value in values.items())
    if found[1] or text_name or heading:
        return found
    return "", thing.get("DESC", "").strip() or thing.get("LONG-NAME", "").strip()


def _first(values: dict[str, str], names: Sequence[str]) -> tuple[str, str]:
    """The first of these attributes that has a value, in any case."""
    by = {name.lower(): name for name in reversed(values) if values[name].strip()}
    name = next((by[name.lower()] for name in names if name.lower() in by), "")
    return name, values.get(name, "")


def _listed(names: Iterable[str]) -> str:
    known = sorted({name for name in names if name})[:20]
    return f"the file has the attributes {', '.join(known)}" if known else "the file defines no attributes"


_ATTRIBUTES = (("id", "ReqIF.ForeignID"), ("text", "ReqIF.Text"), ("status", "Clearance.Status"))


def write(rows: Iterable[tuple[str, str, str, str]], at: float, tool: str) -> bytes:
    """A ReqIF file of (id, text, status, sentence) of each requirement; at: seconds since 1970."""
    when = datetime.fromtimestamp(at, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    Xml.register_namespace("", NAMESPACE)
    root = Xml.Element(f"{{{NAMESPACE}}}REQ-IF")
    header = _in(_in(root, "THE-HEADER"), "REQ-IF-HEADER", IDENTIFIER="clearance-header")
    for tag, text in (("CREATION-TIME", when), ("REQ-IF-TOOL-ID", tool), ("REQ-IF-VERSION", "1.0")):
        _in(header, tag).text = text
    _in(header, "SOURCE-TOOL-ID").text = tool
    _in(header, "TITLE").text = "Requirements with their status"
    content = _in(_in(root, "CORE-CONTENT"), "REQ-IF-CONTENT")
    stamp = {"LAST-CHANGE": when}
    _in(
        _in(content, "DATATYPES"),
        "DATATYPE-DEFINITION-STRING",
        IDENTIFIER="dt-text",
        **stamp,
        **{"MAX-LENGTH": "32000"},
    )
    types = _in(content, "SPEC-TYPES")
    defined = _in(_in(types, "SPEC-OBJECT-TYPE", IDENTIFIER="type", **stamp), "SPEC-ATTRIBUTES")
    for key, name in (*_ATTRIBUTES, ("sentence", "Clearance.Sentence")):
        one = _in(defined, "ATTRIBUTE-DEFINITION-STRING", IDENTIFIER=f"attribute-{key}", **stamp, **{"LONG-NAME": name})
        _in(_in(one, "TYPE"), "DATATYPE-DEFINITION-STRING-REF").text = "dt-text"
    _in(types, "SPECIFICATION-TYPE", IDENTIFIER="specification-type", **stamp)
    objects = _in(content, "SPEC-OBJECTS")
    specification = _in(_in(content, "SPECIFICATIONS"), "SPECIFICATION", IDENTIFIER="specification", **stamp)
    _in(_in(specification, "TYPE"), "SPECIFICATION-TYPE-REF").text = "specification-type"
    children = _in(specification, "CHILDREN")
    for number, values in enumerate(rows, 1):
        _object(objects, children, number, values, stamp)
    Xml.indent(root)
    made: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return made + b"\n"


def _object(
    objects: Xml.Element, children: Xml.Element, number: int, values: tuple[str, ...], stamp: dict[str, str]
) -> None:
    thing = _in(objects, "SPEC-OBJECT", IDENTIFIER=f"object-{number}", **stamp)
    cells = _in(thing, "VALUES")
    for key, value in zip(("id", "text", "status", "sentence"), values, strict=True):
        one = _in(cells, "ATTRIBUTE-VALUE-STRING", **{"THE-VALUE": FORBIDDEN.sub("\ufffd", value)})
        _in(_in(one, "DEFINITION"), "ATTRIBUTE-DEFINITION-STRING-REF").text = f"attribute-{key}"
    _in(_in(thing, "TYPE"), "SPEC-OBJECT-TYPE-REF").text = "type"
    place = _in(children, "SPEC-HIERARCHY", IDENTIFIER=f"place-{number}", **stamp)
    _in(_in(place, "OBJECT"), "SPEC-OBJECT-REF").text = f"object-{number}"


def _in(parent: Xml.Element, tag: str, **attributes: str) -> Xml.Element:
    return Xml.SubElement(parent, f"{{{NAMESPACE}}}{tag}", attributes)
