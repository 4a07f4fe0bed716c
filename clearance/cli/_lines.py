"""The lines of a campaign's text on which its parts are, for reports that point at them."""

from __future__ import annotations

from collections.abc import Mapping

import yaml

Place = tuple[int, int]
"""Line and column of a key, from 1."""


def lines(text: str) -> dict[str, Place]:
    """The line of each part of a campaign, by its path: `criterion`, `uncertain.vehicle.m`, `stages.search`.

    Empty for a text that cannot be read, which a campaign that was submitted never is.
    """
    found: dict[str, Place] = {}
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, RecursionError):
        return found
    waiting: list[tuple[str, yaml.Node]] = [] if root is None else [("", root)]
    while waiting:
        path, node = waiting.pop()
        if not isinstance(node, yaml.MappingNode) or path.count(".") > 8:
            continue
        for key, value in node.value:
            if isinstance(key, yaml.ScalarNode):
                inner = f"{path}.{key.value}" if path else str(key.value)
                found.setdefault(inner, (key.start_mark.line + 1, key.start_mark.column + 1))
                waiting.append((inner, value))
    return found


def first(known: Mapping[str, Place], *paths: str) -> Place:
    """The place of the first part that the text has; its beginning if it has none of them."""
    return next((known[path] for path in paths if path in known), (1, 1))
