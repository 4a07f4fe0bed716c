"""What a module's text means: a digest of its syntax tree, without comments and docstrings, computed once per text.

To compute those of the whole installation takes a second of processor time, at the start of every process that
simulates: they are stored by the digest of the text.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import json
import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from worker.engine.kernels.folder import cache_folder

_DIGEST = re.compile(r"[0-9a-f]{16}")


def meanings(files: Mapping[str, bytes]) -> dict[str, str]:
    """The digest of each module by its name, from its content."""
    texts = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    file = _file()
    stored = _stored(file)
    known = {text: stored.get(text) or meaning(files[name]) for name, text in texts.items()}
    if not known.keys() <= stored.keys():
        _store(file, known)
    return {name: known[text] for name, text in texts.items()}


def meaning(content: bytes) -> str:
    """A digest of a module by its syntax tree; of a compiled module, by its bytes. 16 hexadecimal digits."""
    tokens: list[str] = []
    try:
        _tokens(ast.parse(content), tokens)
    except (SyntaxError, ValueError):
        return hashlib.sha256(content).hexdigest()[:16]
    return hashlib.sha256("\0".join(tokens).encode("utf-8", "surrogatepass")).hexdigest()[:16]


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


def _file() -> Path:
    """Where this installation stores digests; other code computes other ones, and stores them elsewhere.

    The code is that which runs: the text of this file may have been edited since.
    """
    codes = [(code.co_code, code.co_names, code.co_consts) for code in (meaning.__code__, _tokens.__code__)]
    key = hashlib.sha256(f"{sys.version} {Path(__file__).parent} {codes}".encode())
    return cache_folder() / "meanings" / f"{key.hexdigest()[:32]}.json"


def _stored(file: Path) -> dict[str, str]:
    """Digests by the digest of the text; empty where nothing can be read."""
    try:
        found: Any = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    if not isinstance(found, dict) or not all(isinstance(d, str) and _DIGEST.fullmatch(d) for d in found.values()):
        return {}
    return found


def _store(file: Path, known: Mapping[str, str]) -> None:
    """Store the digests of the present texts only, so that the file does not grow; nothing if it cannot be written."""
    draft = file.with_suffix(f".{os.getpid()}")
    with contextlib.suppress(OSError):
        draft.parent.mkdir(parents=True, exist_ok=True)
        draft.write_text(json.dumps(known), encoding="utf-8")
        try:
            draft.replace(file)
        except OSError:
            draft.unlink()
