"""Finds the rule of a request, in the order in which the application's routes are matched.

The guard decides before the framework selects a route. Both take the first route of which path and method match, from
the same list, so they select the same one; a test compares them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple, cast

from fastapi import routing
from starlette.routing import BaseRoute, Route, WebSocketRoute, compile_path
from starlette.types import Scope

from backend.access.rules import OPEN, PAGES, READ, RULES, STATIC, STATIC_FOLDER, Method, Rule

Key = tuple[Method, str]


class MissingRuleError(RuntimeError):
    """A route without a rule, or a rule without a route."""


class _Matched(NamedTuple):
    pattern: re.Pattern[str]
    methods: Mapping[str, Rule]
    path: str


class Rules:
    def __init__(self, routes: Iterable[BaseRoute], rules: Mapping[Key, Rule] = RULES) -> None:
        """Raises `MissingRuleError` unless every route has a rule and every rule a route."""
        found = list(listed(routes))
        keys = {(method, path) for path, methods in found for method in methods}
        missing, unused = keys - rules.keys(), rules.keys() - keys
        if missing or unused:
            raise MissingRuleError(
                "the table of backend.access.rules is not that of the routes: "
                + "; ".join([*(f"no rule for {' '.join(k)}" for k in sorted(missing)),
                             *(f"no route for {' '.join(k)}" for k in sorted(unused))])
            )  # fmt: skip
        self._routes = [
            _Matched(compile_path(path)[0], {method: rules[method, path] for method in methods}, path)
            for path, methods in found
        ]

    def of(self, scope: Scope) -> Rule:
        """The rule of a request or socket; an unknown address is for all who are signed in, who are answered 404."""
        method, path = "SOCKET" if scope["type"] == "websocket" else _method(scope["method"]), scope["path"]
        for route in self._routes:
            if method in route.methods and route.pattern.match(path):
                static = route.path == PAGES and (path in STATIC or path.startswith(STATIC_FOLDER))
                return OPEN if static else route.methods[method]
        return READ

    def path_of(self, method: Method, path: str) -> str | None:
        """The route that is selected for a path."""
        return next((r.path for r in self._routes if method in r.methods and r.pattern.match(path)), None)


def listed(routes: Iterable[BaseRoute], prefix: str = "") -> Iterator[tuple[str, tuple[Method, ...]]]:
    """Path and methods of every route, in the order of matching."""
    for route in routes:
        if isinstance(route, routing._IncludedRouter):
            yield from listed(route.original_router.routes, prefix + route.include_context.prefix)
        elif isinstance(route, WebSocketRoute):
            yield prefix + route.path, ("SOCKET",)
        elif isinstance(route, Route):
            methods = sorted({_method(name) for name in route.methods or ()})
            yield prefix + route.path, tuple(cast(Method, name) for name in methods)
        else:
            raise MissingRuleError(
                f"{type(route).__name__} {getattr(route, 'path', '')!r}: no rule covers such a route"
            )


def _method(name: str) -> str:
    """HEAD is answered as GET."""
    return "GET" if name == "HEAD" else name
