"""Reads the XHTML of a requirement as plain text, in which everything is written that changes its meaning."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from xml.etree import ElementTree as Xml

_BLOCKS = (
    "p", "div", "br", "hr", "pre", "address", "blockquote", "h1", "h2", "h3", "h4", "h5", "h6",
    "ul", "ol", "li", "dl", "dt", "dd", "table", "caption", "tr",
)  # fmt: skip
_SPACE = re.compile(r"\s+")

# Marks of what is written once its end is known. XML cannot contain these characters, so no text is taken for a mark.
_MARKS = {
    "sup": "\x01", "sub": "\x02", "td": "\x03", "th": "\x03",
    "del": "\x04", "s": "\x04", "strike": "\x04", "ins": "\x05",
}  # fmt: skip
_STYLES = (("line-through", "del"), ("super", "sup"), ("sub", "sub"))
"""A word of the attribute `style` that means what a tag means."""
_CHANGES = {_MARKS["del"]: "deleted", _MARKS["ins"]: "inserted"}
_END, _CELL = "\x06", "\x07"
_INNERMOST = re.compile(r"([\x01-\x05])([^\x01-\x06]*)\x06(?=(.?.?))", re.DOTALL)
_STYLED = re.compile(r"\b(?:text-decoration(?:-line)?|vertical-align)\s*:([^;]*)", re.IGNORECASE)
_SIMPLE = re.compile(r"[+\-−]?[^\W_]+")
_GOES_ON = re.compile(r"[\w^]|[.,]\w")


def plain(xhtml: Xml.Element) -> str:
    """The words of XHTML; blocks are on lines of their own. Without recursion, in the order of the document.

    What changes the meaning is written: 10^3, 10^(n+1), x_i, `a | b` for the cells of a row, [picture a.png], and of
    tracked changes [deleted: 1] and [inserted: 0.5].
    """
    found: list[str] = []
    waiting: list[tuple[Xml.Element | None, str]] = [(xhtml, "")]
    while waiting:
        element, after = waiting.pop()
        if element is None:
            found.append(after)
            continue
        begin, end = _around(element)
        found.append(begin + _SPACE.sub(" ", element.text or ""))
        waiting.append((None, end + _SPACE.sub(" ", after)))
        waiting += [(child, child.tail or "") for child in reversed(element)]
    text, before = "".join(found), ""
    while text != before:
        text, before = _INNERMOST.sub(_resolved, text), text
    return "\n".join(_lines(text))


def _around(element: Xml.Element) -> tuple[str, str]:
    inner = "".join(dict.fromkeys(_MARKS[tag] for tag in _meant(element)))
    outer, end = ("\n", "\n") if element.tag in _BLOCKS else ("", "")
    begin, end = outer + inner, _END * len(inner) + end
    if element.tag in ("object", "img"):
        inside = " " if (element.text or "").strip() or len(element) else ""  # words for those who cannot see it
        return f"{begin}[picture {_picture(element)}]{inside}", inside + end
    return begin, end


def _meant(element: Xml.Element) -> Iterator[str]:
    """The tags of `_MARKS` that an element is, or is styled as; a cell first, which contains the others."""
    if element.tag in _MARKS:
        yield element.tag
    words = " ".join(_STYLED.findall(element.get("style") or "")).lower().split()
    yield from (tag for word, tag in _STYLES if word in words)


def _picture(element: Xml.Element) -> str:
    """The name of a picture; the digest of one that is within the file, so that another one is another text."""
    name = element.get("data") or element.get("src") or element.get("alt") or "without a name"
    if name.startswith("data:"):
        name = f"{name[5:].split(',')[0].split(';')[0]} {hashlib.sha256(name.encode()).hexdigest()[:12]}"
    return " ".join(name.split())


def _resolved(marked: re.Match[str]) -> str:
    """A cell or change as one line; a script in parentheses, unless it is one word or number that ends it."""
    mark, content, following = marked.groups()
    lines = _lines(content)
    if mark == _MARKS["td"]:
        return _CELL + "; ".join(lines)
    script = " ".join(lines)
    if not script:
        return ""
    if mark in _CHANGES:
        return f"[{_CHANGES[mark]}: {script}]"
    if not _SIMPLE.fullmatch(script) or _GOES_ON.match(following):
        script = f"({script})"
    return ("^" if mark == _MARKS["sup"] else "_") + script


def _lines(text: str) -> list[str]:
    """The lines that have words, with the cells of a row separated."""
    found = []
    for line in text.splitlines():
        before, *cells = (" ".join(cell.split()) for cell in line.split(_CELL))
        if before or any(cells):
            found.append(" | ".join([before, *cells] if before else cells).strip())
    return found
