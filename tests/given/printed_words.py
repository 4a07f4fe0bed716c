"""The words of a PDF that Chromium printed: its fonts' codes, by the tables that a reader copies text with.

Chromium writes plain objects, one table of Unicode for each font (ISO 32000-1, 9.10.3), and glyphs as hexadecimal.
"""

from __future__ import annotations

import re
import zlib

_FONT = re.compile(rb"\n(\d+) 0 obj\n<<[^>]*/ToUnicode (\d+) 0 R")
_STREAM = re.compile(rb"\n(\d+) 0 obj\n<<[^>]*/FlateDecode\s*/Length (\d+)>> stream\n")
_SHOWN = re.compile(rb"/F(\d+) [\d.]+ Tf|<([0-9A-Fa-f]+)>(?=[^\[\]]*?T[jJ])")
_MAPPED = re.compile(rb"beginbf(char|range)(.*?)endbf", re.DOTALL)


def printed_words(document: bytes) -> str:
    """All text in the order in which it is drawn, without spaces, which are not always drawn."""
    contents = {
        int(found[1]): zlib.decompress(document[found.end() : found.end() + int(found[2])])
        for found in _STREAM.finditer(document)
    }
    fonts = {int(font): _characters(contents[int(table)]) for font, table in _FONT.findall(document)}
    drawn: list[str] = []
    for content in contents.values():
        known: dict[int, str] = {}
        for font, codes in _SHOWN.findall(content):
            if font:
                known = fonts.get(int(font), {})
            elif known:
                drawn += [known.get(int(codes[at : at + 4], 16), "?") for at in range(0, len(codes), 4)]
    return "".join("".join(drawn).split())


def _characters(table: bytes) -> dict[int, str]:
    """The characters of a font by the codes of their glyphs."""
    found: dict[int, str] = {}
    for kind, rows in _MAPPED.findall(table):
        for row in rows.strip().splitlines():
            first, *rest = [bytes.fromhex(word.decode()) for word in re.findall(rb"<([0-9A-Fa-f]+)>", row)]
            low = int.from_bytes(first)
            last = int.from_bytes(rest[0]) if kind == b"range" else low
            text = rest[-1].decode("utf-16-be")
            found |= {code: text[:-1] + chr(ord(text[-1]) + code - low) for code in range(low, last + 1)}
    return found
