"""What a module's text means: a digest of its syntax tree without documentation, and what it imports; once per text.

To compute those of the whole installation takes a second of processor time, at the start of every process that
simulates: they are stored by the digest of the text.
"""

from __future__ import annotations

import ast
import hashlib
import json
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import CodeType
from typing import Any, NamedTuple

from worker.engine.kernels.folder import cache_folder, store
from worker.engine.search.base import Ended, Method, MethodLook

_TEXTS: dict[tuple[str, str], frozenset[int | str]] = {
    (Ended.__module__, Ended.__name__): frozenset({1}),
    (Method.__module__, Method.__name__): frozenset({"title", "how", "source", "parallel", "suits", "drawback"}),
    (MethodLook.__module__, MethodLook.__name__): frozenset({"colour", "dark", "marker", "short"}),
    ("pydantic", "Field"): frozenset({"description"}),
}
"""Arguments, by place or name, that only tell or show a reader something: `Ended("drawn", "{samples} samples")`."""
_NAME = re.compile(r"worker(\.\w+)+")


class Import(NamedTuple):
    """One imported name: of a module (with leading dots if relative), its name there ("" for the whole), and here."""

    module: str
    name: str
    here: str


class Meaning(NamedTuple):
    """16 hexadecimal digits, and the imports that are executed: not those for annotations alone."""

    digest: str
    imports: tuple[Import, ...] = ()


def meanings(files: Mapping[str, bytes]) -> dict[str, Meaning]:
    """The meaning of each module by its name, from its content."""
    texts = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    file = _file()
    stored = _stored(file)
    known = {text: stored.get(text) or meaning(files[name]) for name, text in texts.items()}
    if not known.keys() <= stored.keys():
        store(file, json.dumps(known))  # of the present texts only, so that the file does not grow
    return {name: known[text] for name, text in texts.items()}


def meaning(content: bytes) -> Meaning:
    """The meaning of a module by its syntax tree; of a compiled module, by its bytes."""
    tokens: list[str] = []
    try:
        tree = ast.parse(content)
        imports = tuple(dict.fromkeys(_imports(tree)))
        _unworded(tree, imports)
        _tokens(tree, tokens)
    except (SyntaxError, ValueError):
        return Meaning(hashlib.sha256(content).hexdigest()[:16])
    digest = hashlib.sha256("\0".join(tokens).encode("utf-8", "surrogatepass")).hexdigest()[:16]
    return Meaning(digest, imports)


def _unworded(tree: ast.AST, imports: tuple[Import, ...]) -> None:
    """Take the texts for readers out of the calls of `_TEXTS`."""
    texts = {one.here: found for one in imports if (found := _TEXTS.get((one.module, one.name)))}
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in texts:
            out = texts[node.func.id]
            node.args = [a for i, a in enumerate(node.args) if i not in out or not isinstance(a, ast.Constant)]
            node.keywords = [k for k in node.keywords if k.arg not in out or not isinstance(k.value, ast.Constant)]


def _tokens(node: Any, tokens: list[str]) -> None:
    """A syntax tree without positions, comments and loose strings; the same in every version of Python."""
    if isinstance(node, ast.AST):
        tokens.append(type(node).__name__)
        for name in node._fields:
            value = getattr(node, name, None)
            if value is not None and value != [] and name != "ctx":
                tokens.append(name)
                _tokens(value, tokens)
        tokens.append(")")
    elif isinstance(node, list):
        for item in node:
            if not (isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant)):
                _tokens(item, tokens)
        tokens.append("]")
    else:
        tokens.append(repr(node))


def _imports(node: ast.AST) -> Iterator[Import]:
    """The imports at any depth of the module; modules that generated code names are texts."""
    if isinstance(node, ast.Import):
        yield from (Import(alias.name, "", alias.asname or alias.name) for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        module = "." * node.level + (node.module or "")
        yield from (Import(module, alias.name, alias.asname or alias.name) for alias in node.names)
    elif isinstance(node, ast.If) and ast.unparse(node.test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING"):
        for other in node.orelse:
            yield from _imports(other)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str) and _NAME.fullmatch(node.value):
        yield Import(node.value, "", "")
    else:
        for child in ast.iter_child_nodes(node):
            yield from _imports(child)


def _file() -> Path:
    """The file in which this installation stores meanings; other code computes other ones, and stores them elsewhere.

    The code is that which runs: the text of this file may have been edited since.
    """
    codes = [_essence(function.__code__) for function in (meaning, _unworded, _tokens, _imports)]
    texts = [(called, sorted(map(str, arguments))) for called, arguments in sorted(_TEXTS.items())]
    key = hashlib.sha256(f"{sys.version} {Path(__file__).parent} {codes} {texts}".encode())
    return cache_folder() / "meanings" / f"{key.hexdigest()[:32]}.json"


def _essence(code: CodeType) -> tuple[object, ...]:
    """What a function executes, without addresses and lines."""
    inner = [_essence(each) if isinstance(each, CodeType) else each for each in code.co_consts]
    return code.co_code, code.co_names, inner


def _stored(file: Path) -> dict[str, Meaning]:
    """Meanings by the digest of the text; empty where nothing can be read."""
    try:
        found: Any = json.loads(file.read_text(encoding="utf-8"))
        return {text: _read(*one) for text, one in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def _read(digest: Any, imports: Any) -> Meaning:
    if not isinstance(digest, str) or len(digest) != 16 or not digest.isalnum():
        raise ValueError(f"{digest!r:.40} is not a digest of 16 hexadecimal digits")
    return Meaning(digest, tuple(Import(str(module), str(name), str(here)) for module, name, here in imports))
