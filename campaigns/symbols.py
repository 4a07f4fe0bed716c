"""The printed label of a parameter: its symbol if no other parameter of the campaign has it, otherwise its path.

Two obstacles have the same symbols; a number must be traceable to one of them. Start reading at `labels`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping


def labels(paths: Iterable[str], symbols: Mapping[str, str]) -> dict[str, str]:
    """The label of each path; symbols: of all parameters of the campaign, by path."""
    asked = list(paths)
    named = {path: path.rpartition(".")[2] for path in asked} | dict(symbols)
    counts = Counter(named.values())
    return {path: named[path] if counts[named[path]] == 1 else path for path in asked}


def is_path(label: str) -> bool:
    """Whether a label is a path; no symbol has a dot."""
    return "." in label
