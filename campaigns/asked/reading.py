"""Reads text as plain JSON values: JSON by RFC 8259, YAML by the core schema of YAML 1.2 (section 10.3), restricted.

Aliases, tags, repeated keys, keys that are not text, and deep nesting are refused. `1e-3` is a number; `no`, `012:30`
and `2026-01-31` are text. `Dumper` writes text that `parse` reads.
"""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Iterable, Iterator
from typing import Any

import yaml

from campaigns.asked.problem import Problem, shown

DEEPEST = 16
"""A campaign nests 6 deep; parameters may be written nested."""

MOST_VALUES = 60_000
"""The largest number of values and keys in a YAML text: 10,000 starts in two parameters have fewer, read in 0.3 s."""

MOST_NESTED = 150_000
"""The largest number of lists and mappings in a document, however it was written: more starts than a body holds."""

LONGEST_KEY = 200
LARGEST_WHOLE = 2**63

_PARSED_DEPTH = 100
"""The reader refuses deeper nesting, to protect Python's stack; up to here `misshapen` reports the location."""

_EXPLAINED = 64_000
"""Longer invalid YAML is reported with libyaml's message; PyYAML's is better but takes 25 us per value."""

TOO_LONG = "a whole number of more than 4,300 digits"
"""Python reads none."""

_TOO_MANY = f"more than {MOST_VALUES:,} values, keys counted: shorten the campaign, or give it as JSON"


class UnreadableError(ValueError):
    """The text is not a valid document; `problem` states where and why."""

    def __init__(self, where: str, message: str) -> None:
        self.problem = Problem(where, "", message)
        super().__init__(str(self.problem))


def parse(text: str) -> Any:
    """The document as plain values; raises `UnreadableError`."""
    text = text.removeprefix("\ufeff")
    try:
        if text.lstrip().startswith("{"):
            try:
                return json.loads(text, object_pairs_hook=_distinct)
            except json.JSONDecodeError:
                pass  # a YAML mapping may also begin with a brace
            except UnreadableError:
                raise
            except ValueError:
                raise UnreadableError("", f"not readable as JSON: {TOO_LONG}") from None
        return _yaml(text)
    except UnreadableError:
        raise
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise UnreadableError(where, f"not readable as YAML: {error.problem or error.context}") from None
    except RecursionError:
        raise UnreadableError("", "not readable as YAML: nested too deeply") from None
    except (yaml.YAMLError, ValueError, ArithmeticError) as error:
        first_line = str(error).partition("\n")[0]
        raise UnreadableError("", f"not readable as YAML: {first_line}") from None


def _yaml(text: str) -> Any:
    """Read YAML with libyaml, which is ten times as fast; refused text is read again with PyYAML for its message."""
    try:
        return yaml.load(text, Loader=_Fast)
    except (_RefusedError, RecursionError):
        raise
    except (yaml.YAMLError, UnicodeEncodeError):
        if len(text) > _EXPLAINED:
            raise
        return yaml.load(text, Loader=_Loader)


def repeated(names: Iterable[str]) -> str | None:
    """The first name that occurs twice, in one pass; None if all are distinct."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return None


Place = tuple[Any, str | int] | None
"""The location of a value: that of its container, and its key; formatted only for an error."""


def field(place: Place) -> str:
    """A location as text, `scenario.obstacles.0`."""
    keys: list[str] = []
    while place is not None:
        keys.append(str(place[1]))
        place = place[0]
    return ".".join(reversed(keys))


def misshapen(document: Any) -> Iterator[Problem]:
    """Locations where a document is not plain JSON of limited depth; a valid document is safe for recursion."""
    waiting: list[tuple[Place, Any, int]] = [(None, document, 0)]
    nested = 0
    while waiting:
        place, value, depth = waiting.pop()
        if isinstance(value, dict | list) and depth > DEEPEST:
            yield Problem(field(place)[:LONGEST_KEY], "", f"nested deeper than {DEEPEST} levels")
            return
        if isinstance(value, dict):
            for key in value:
                if not isinstance(key, str) or len(key) > LONGEST_KEY or not _is_unicode(key):
                    yield Problem(
                        field(place), shown(key), f"a key is Unicode text of at most {LONGEST_KEY} characters"
                    )
                    return
            inside: list[Any] = [key for key, inner in value.items() if not _plain(inner, depth)]
        elif isinstance(value, list):
            inside = [at for at, inner in enumerate(value) if not _plain(inner, depth)]
        elif isinstance(value, str) and not _is_unicode(value):
            yield Problem(field(place), shown(value), "invalid Unicode text: it contains an unpaired surrogate")
        elif isinstance(value, int) and abs(value) > LARGEST_WHOLE:
            yield Problem(field(place), "", "a whole number of more than 64 bits")
        elif value is not None and not isinstance(value, str | int | float | bool):
            yield Problem(field(place), shown(value), "expected text, a number, true, false, null, a list or a mapping")
        if isinstance(value, dict | list):
            nested += len(inside)
            if nested > MOST_NESTED:
                yield Problem("", "", f"more than {MOST_NESTED:,} lists and mappings: shorten the campaign")
                return
            waiting += [((place, key), value[key], depth + 1) for key in reversed(inside)]


def _plain(value: Any, depth: int) -> bool:
    """Whether a value at this depth is fine: most of a large document, of which no place is then noted."""
    kind = type(value)
    if kind is str:
        return value.isascii() or _is_unicode(value)
    if kind is list or kind is dict:
        return not value and depth < DEEPEST
    return kind is float or kind is bool or value is None or (kind is int and -LARGEST_WHOLE <= value <= LARGEST_WHOLE)


def _brief(value: Any) -> str:
    return repr(value[:LONGEST_KEY] if isinstance(value, str | list) else value)[:LONGEST_KEY]


def _is_unicode(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, object]:
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = repeated(name for name, _ in pairs)
        raise UnreadableError("", f"not readable as JSON: the key {_brief(twice)} is given twice")
    return found


class _RefusedError(yaml.MarkedYAMLError):
    """Valid YAML that is not a plain document."""

    def __init__(self, problem: str, mark: Any) -> None:
        super().__init__(problem=problem, problem_mark=mark)


class _Plain(yaml.composer.Composer, yaml.constructor.SafeConstructor):
    """Refuses aliases (which expand a small file), tags, repeated keys, and too many values."""

    values = depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[attr-defined]
        if isinstance(event, yaml.AliasEvent):
            raise _RefusedError("aliases (*name) are not allowed, write the value out", event.start_mark)
        if getattr(event, "tag", None) is not None:
            raise _RefusedError(
                f"tags ({event.tag[:LONGEST_KEY]}) are not allowed, write the plain value", event.start_mark
            )
        self.values += 1
        if self.values > MOST_VALUES:
            raise _RefusedError(_TOO_MANY, event.start_mark)
        if self.depth > _PARSED_DEPTH:
            raise RecursionError
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                raise _RefusedError(f"keys must be text, given {_brief(key)}", key_node.start_mark)
            if key in seen:
                raise _RefusedError(f"the key {_brief(key)} is given twice", key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep)

    def construct_whole(self, node: yaml.ScalarNode) -> int:
        """A whole number is decimal: 012 is 12."""
        try:
            return int(node.value)
        except ValueError:
            raise _RefusedError(TOO_LONG, node.start_mark) from None


class _Loader(_Plain, yaml.SafeLoader):
    """Reads with PyYAML's own scanner and parser."""

    yaml_implicit_resolvers: dict[str, object] = {}


_Parser: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _Fast(_Plain, _Parser):  # type: ignore[misc]
    """Reads with libyaml's scanner and parser, if available; composed in Python, so that values are counted."""

    yaml_implicit_resolvers: dict[str, object] = {}

    def __init__(self, text: str) -> None:
        _Parser.__init__(self, text)
        self.anchors: dict[str, yaml.Node] = {}


_Writer: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


class Dumper(_Writer):  # type: ignore[misc]
    """Quotes text that `parse` would read as another type; with libyaml if available, in a third of the time."""

    yaml_implicit_resolvers: dict[str, object] = {}


_CORE = (
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("bool", r"true|True|TRUE|false|False|FALSE", list("tTfF")),
    ("int", r"[-+]?[0-9]+", list("-+0123456789")),
    (
        "float",
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
)

for _kind, _pattern, _first in _CORE:
    for _reader in (_Loader, _Fast, Dumper):
        _reader.add_implicit_resolver(f"tag:yaml.org,2002:{_kind}", re.compile(f"^(?:{_pattern})$"), _first)
_Plain.add_constructor("tag:yaml.org,2002:int", _Plain.construct_whole)  # type: ignore[type-var]
