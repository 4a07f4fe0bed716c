"""Campaign documents that nobody would write: campaigns of the library, mutated as text and as values.

Everything follows from one generator of random numbers, so that a document is found again by its seed.
"""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import yaml

from campaigns import library


class Body(NamedTuple):
    """The body of a request, and whether it is YAML; otherwise it is JSON."""

    content: bytes
    yaml: bool


NUMBERS = (
    *("0", "-0.0", "1", "-1", "0.1", "1e308", "-1e308", "1e309", "5e-324", "1e12", "1.0000001e12", "-1e12", ".nan"),
    *(".inf", "-.inf", "NaN", "Infinity", "-Infinity", "9" * 400, "9" * 5000, "-" + "9" * 40, "1_000", "0x1F"),
    *("0o17", "1:30:00"),
    *("9223372036854775807", "9223372036854775808", "-9223372036854775809", "18446744073709551616", "1e", "--1", "+.5"),
    *("1e999999999", "1" + "0" * 4301, "0." + "0" * 4000 + "1", "٣", "１２", "1e-400", "20%", "-5%", "1e400%"),
    *("%", "NaN%"),
)  # fmt: skip
WORDS = (
    *("null", "~", "true", "no", "yes", "''", '"\\u0000"', '"\\ud800"', '"\\udfff x"', "'\u202e reversed'", "\ufeff"),
    *("2026-11-22", "!!binary aGVsbG8=", "!!python/object/apply:os.system [id]", "!!python/name:os.system", "!<!>x"),
    *("!!set {a, b}", "!!omap [a: 1]", "!local x", "&a x", "*a", "<<: *a", "|", ">-", "? a", "- - - -", "[[[[", "{{{{"),
    *("[}", "{]", "'", '"', "%YAML 9.9", "%TAG ! tag:x,2000:", "---", "...", "\t", "\r", "\x00", "\x07"),
    *("\x85", "\u2028"),
    *("# comment", "a: b: c", "@x", "`x`", "é", "\U0001f6a9" * 40, "x" * 5000, "x." * 200 + "x", "__proto__"),
    *("vehicle.m", "nan"),
)  # fmt: skip
"""Pieces of text with which readers of YAML and JSON have had trouble."""

VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 2, 3.5, 1e-300, 1e12, 1e13, 1e308, float("inf"), float("-inf"), float("nan")),
    *(2**31, 2**53, 2**63 - 1, 2**63, -(2**63) - 1, 10**300, "", " ", "0", "20%", "-20%", "1e400%", "nan", "\0"),
    *("inf", "\ud800", "x\udfff", "٣", "x" * 300, "x" * 20_001, "x" * 100_000, "\u202e", "a.b", "vehicle.m"),
    *("obstacles.999.x", [], {}, [[]], [{}], {"": 0}, {"a": {}}, [None] * 600, [0] * 3000, {"component": "circle"}),
    *({"name": "drop"}, {str(i): i for i in range(600)}, {"x" * 300: 1}, {"__class__": "x"}, {"command": ["id"]}),
    *({"plus_minus": "1e300%"},),
    *([1e308, 1e308], [1, 0], [float("nan")] * 2, {"low": 1, "high": 0}, {"distribution": {"kind": "beta"}}),
)  # fmt: skip


@cache
def _texts() -> tuple[str, ...]:
    return tuple(path.read_text(encoding="utf-8") for path in library().values())


@cache
def _documents() -> tuple[Any, ...]:
    return tuple(yaml.safe_load(text) for text in _texts())


def document(seed: int) -> Body:
    """The document of a seed: one to five mutations of a campaign, one in fifty of a form that grows."""
    choose = random.Random(seed)
    if choose.random() < 0.02:
        return choose.choice(GROWING)(choose)
    if choose.random() < 0.5:
        return _text(choose)
    return _value(choose)


def _times(choose: random.Random) -> range:
    return range(choose.choice((1, 1, 1, 2, 3, 5)))


def mutated(text: str, seed: int) -> bytes:
    """Any text with one to five mutations, one in ten of its bytes."""
    choose = random.Random(seed)
    for _ in _times(choose):
        text = choose.choice(TEXTUAL)(choose, text)
    content = text.encode("utf-8", "surrogatepass")
    return choose.choice(BYTES)(choose, content) if choose.random() < 0.1 else content


# Text


def _text(choose: random.Random) -> Body:
    as_json = choose.random() < 0.3
    at = choose.randrange(len(_texts()))
    text = json.dumps({"campaign": _documents()[at]}) if as_json else _texts()[at]
    for _ in _times(choose):
        text = choose.choice(TEXTUAL)(choose, text)
    content = text.encode("utf-8", "surrogatepass")
    if choose.random() < 0.1:
        content = choose.choice(BYTES)(choose, content)
    return Body(content, not as_json)


def _place(choose: random.Random, text: str) -> int:
    return choose.randint(0, len(text))


def _insert(choose: random.Random, text: str) -> str:
    at = _place(choose, text)
    return text[:at] + choose.choice(WORDS + NUMBERS) + text[at:]


def _cut(choose: random.Random, text: str) -> str:
    a, b = sorted((_place(choose, text), _place(choose, text)))
    return text[:a] + text[min(b, a + choose.choice((1, 5, 50, 5000))) :]


def _swap(choose: random.Random, text: str) -> str:
    """One character becomes another one of the syntax."""
    at = _place(choose, text)
    return text[:at] + choose.choice("{}[]:,-#&*!|>'\"%@`\\\n\t ?0") + text[at + 1 :]


def _line(choose: random.Random, text: str) -> str:
    """One line is repeated, moved in depth, or goes elsewhere."""
    lines = text.split("\n")
    at = choose.randrange(len(lines))
    how = choose.randrange(4)
    if how == 0:
        lines.insert(at, lines[at])
    elif how == 1:
        lines[at] = " " * choose.choice((1, 2, 4, 40)) + lines[at]
    elif how == 2:
        lines.insert(choose.randrange(len(lines) + 1), lines.pop(at))
    else:
        lines[at] = lines[at].lstrip()
    return "\n".join(lines)


def _number(choose: random.Random, text: str) -> str:
    """One number becomes another one."""
    places = [i for i, c in enumerate(text) if c.isascii() and c.isdigit()]
    if not places:
        return text
    a = b = choose.choice(places)
    while b < len(text) and (text[b].isdigit() or text[b] in ".eE%"):
        b += 1
    return text[:a] + choose.choice(NUMBERS) + text[b:]


def _scalar(choose: random.Random, text: str) -> str:
    """What follows one colon becomes something else."""
    places = [i for i, c in enumerate(text) if c == ":"]
    if not places:
        return text
    a = choose.choice(places) + 1
    b = min((i for i in (text.find(c, a) for c in ",\n}]") if i >= 0), default=len(text))
    return f"{text[:a]} {choose.choice(WORDS + NUMBERS)}{text[b:]}"


def _splice(choose: random.Random, text: str) -> str:
    other = choose.choice(_texts())
    return text[: _place(choose, text)] + other[_place(choose, other) :]


TEXTUAL: tuple[Callable[[random.Random, str], str], ...] = (_insert, _cut, _swap, _line, _number, _scalar, _splice)


def _flipped(choose: random.Random, content: bytes) -> bytes:
    found = bytearray(content)
    for _ in range(choose.choice((1, 3, 30))):
        if found:
            found[choose.randrange(len(found))] = choose.randrange(256)
    return bytes(found)


def _recoded(choose: random.Random, content: bytes) -> bytes:
    text = content.decode("utf-8", "replace")
    return text.encode(choose.choice(("utf-16", "utf-32", "latin-1", "utf-7", "utf-8-sig")), "replace")


BYTES: tuple[Callable[[random.Random, bytes], bytes], ...] = (_flipped, _recoded)


# Values


def _value(choose: random.Random) -> Body:
    made = copy.deepcopy(choose.choice(_documents()))
    for _ in _times(choose):
        made = _mutated(choose, made)
    if choose.random() < 0.3:
        return Body(yaml.safe_dump(made, allow_unicode=choose.random() < 0.5).encode("utf-8", "surrogatepass"), True)
    made = {"campaign": made} if choose.random() < 0.95 else made
    return Body(json.dumps(made, ensure_ascii=choose.random() < 0.5).encode("utf-8", "surrogatepass"), False)


def _mutated(choose: random.Random, made: Any) -> Any:
    """One value, at any depth, is replaced, removed, renamed, repeated, scaled or wrapped."""
    found: list[tuple[Any, Any]] = []
    waiting = [made]
    while waiting:
        holder = waiting.pop()
        pairs = holder.items() if isinstance(holder, dict) else enumerate(holder) if isinstance(holder, list) else ()
        for key, inner in pairs:
            found.append((holder, key))
            waiting.append(inner)
    if not found:
        return copy.deepcopy(choose.choice(VALUES))
    holder, key = choose.choice(found)
    how = choose.randrange(7)
    inner = holder[key]
    if how == 0:
        holder[key] = copy.deepcopy(choose.choice(VALUES))
    elif how == 1:
        del holder[key]
    elif how == 2 and isinstance(holder, dict):
        holder[choose.choice(("x", "", "code", "path", "m.x", "a" * 300, "\u202e", f"{key} "))] = holder.pop(key)
    elif how == 3 and isinstance(inner, list):
        holder[key] = [copy.deepcopy(one) for one in inner] * choose.choice((0, 2, 33, 65, 1001))
    elif how == 4 and isinstance(inner, int | float) and not isinstance(inner, bool) and abs(inner) < 1e300:
        holder[key] = inner * choose.choice((-1, 0, 0.5, 10, 1e3, 1e6, 1e-6, 1e-9, 1e7))
    elif how == 5:
        holder[key] = {"x": inner} if choose.random() < 0.5 else [inner]
    else:
        other, there = choose.choice(found)
        if (isinstance(other, dict) and there not in other) or (isinstance(other, list) and there >= len(other)):
            return made
        holder[key] = copy.deepcopy(other[there])
    return made


# Forms that grow

PIECES = (
    *(("[[]],", 380_000), ('{"":0},', 250_000), ("[],", 600_000), ("{},", 600_000), ("1,", 900_000), ('"",', 600_000)),
    *(("x,", 450_000), ('"\\ud800",', 190_000)),
)
FILLERS = ("x", "9", " ", "\n", "-", "\t", "'", "\\", "#", "\U0001f6a9", "a b ", "? ", "- ", "!", "&", "e", "x: ")
AROUND = (("name: ", ""), ("", ": 1"), ('name: "', '"'), ("name: |\n  ", ""), ("# ", "\nname: x"))


def _deep(choose: random.Random) -> Body:
    n = choose.choice((17, 99, 101, 999, 5000, 100_000))
    opened, closed = choose.choice((("[", "]"), ('{"a":', "}"), ("{a: ", "}"), ("- ", "")))
    whole = choose.random() < 0.5
    text = opened * n + (("1" + closed * n) if whole else "")
    return Body((f"scenario: {text}" if choose.random() < 0.5 else text).encode(), choose.random() < 0.7)


def _indented(choose: random.Random) -> Body:
    n = choose.choice((20, 120, 900))
    return Body("\n".join(" " * i + "a:" for i in range(n)).encode(), True)


def _aliases(choose: random.Random) -> Body:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]
    return Body("\n".join([*lines, choose.choice(_texts())]).encode(), True)


def _many(choose: random.Random) -> Body:
    """As many values as the largest body holds."""
    piece, n = choose.choice(
        (
            ("[[]],", 380_000),
            ('{"":0},', 250_000),
            ("[],", 600_000),
            ("{},", 600_000),
            ("1,", 900_000),
            ('"",', 600_000),
            ("x,", 450_000),
        )
    )
    n = choose.choice((n, n // 10))
    text = f'{{"campaign": {{"name": [{piece * n}1]}}}}' if choose.random() < 0.5 else f"[{piece * n}1]"
    return Body(text.encode(), choose.random() < 0.5)


def _keys(choose: random.Random) -> Body:
    n = choose.choice((1000, 30_000, 99_000))
    body = ",".join(f'"k{i}": {i}' for i in range(n))
    return Body(f'{{"campaign": {{{body}}}}}'.encode(), choose.random() < 0.5)


def _long(choose: random.Random) -> Body:
    """One long scalar, key, comment, number or run of blanks."""
    filler = choose.choice(
        ("x", "9", " ", "\n", "-", "\t", "'", "\\", "#", "\U0001f6a9", "a b ", "? ", "- ", "!", "&", "e", "x: ")
    )
    n = choose.choice((10_000, 990_000)) // len(filler.encode())
    begin, end = choose.choice(
        (("name: ", ""), ("", ": 1"), ('name: "', '"'), ("name: |\n  ", ""), ("# ", "\nname: x"))
    )
    return Body((begin + filler * n + end).encode(), choose.random() < 0.7)


def _starts(choose: random.Random) -> Body:
    """A campaign with very many of one of its lists."""
    made = copy.deepcopy(choose.choice(_documents()))
    n = choose.choice((32, 1000, 10_000))
    how = choose.randrange(5)
    paths = list(made.get("uncertain", {}))
    if how == 0:
        made["stages"]["search"][0]["starts"] = [dict.fromkeys(paths, float(i)) for i in range(n)]
    elif how == 1:
        made["uncertain"] = {f"vehicle.p{i}": {"low": 0, "high": i + 1} for i in range(n)}
    elif how == 2:
        made["correlations"] = [{"between": [f"a.b{i}", f"a.c{i}"], "value": 0.5} for i in range(n)]
    elif how == 3:
        made["uncertain"] = {f"vehicle.p{i}": {"low": 0, "high": 1} for i in range(64)}
        pairs = [(i, j) for i in range(64) for j in range(i)][: n // 4]
        made["correlations"] = [{"between": [f"vehicle.p{i}", f"vehicle.p{j}"], "value": 0.1} for i, j in pairs]
    else:
        made["stages"]["search"] = made["stages"]["search"][:1] * n
    return Body(json.dumps({"campaign": made}).encode(), False)


GROWING: tuple[Callable[[random.Random], Body], ...] = (
    _deep, _indented, _aliases, _many, _keys, _long, _starts
)  # fmt: skip
