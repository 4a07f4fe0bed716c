"""The table of rules: every route x every role and scope, without sign-in, revoked, from a foreign origin.

One application and one database; the guard is asked in-process, and what it lets in is counted, not executed.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import sqlalchemy as sa
from fastapi import APIRouter, FastAPI, routing
from starlette.routing import Match, Mount

from backend.access import routes
from backend.access.auth import Guard
from backend.access.frames import Frames
from backend.access.rates import Rates
from backend.access.routes import MissingRuleError, Rules
from backend.access.rule_table import table
from backend.access.rules import RULES, Method, Rule
from backend.app import create
from backend.db import access, users
from backend.db.engine import connect
from backend.db.roles import ROLES, SCOPES, Role
from backend.db.tables import Token
from backend.settings import Settings
from tests.api.conftest import Fresh
from tests.given.openapi_document import filled

DOCUMENT = Path(__file__).parents[3] / "docs" / "access.md"
HOST = b"clearance.test"


class Desk(NamedTuple):
    """An application with its guard, and the header by which each visitor signs in."""

    app: FastAPI
    guard: Guard
    visitors: Mapping[str, tuple[bytes, bytes]]


@pytest.fixture(scope="module")
def desk(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Desk]:
    folder = tmp_path_factory.mktemp("rules")
    url = fresh_sqlite(folder / "data")
    app = create(Settings(data=folder / "data", database=url, pages=folder / "dist"))
    engine = connect(url)
    with engine.begin() as writer:
        visitors = dict(_visitors(writer, app.state.settings.cookie))
    engine.dispose()

    async def inside(scope: Any, receive: Any, send: Any) -> None:
        scope["entered"].append(scope["path"])

    yield Desk(app, Guard(inside, app.state.door, 100, Rates(10**7), Frames()), visitors)
    asyncio.run(app.state.door.close())
    app.state.engine.dispose()


def _visitors(writer: sa.Connection, cookie: str) -> Iterator[tuple[str, tuple[bytes, bytes]]]:
    for role in ROLES:
        users.accept(writer, users.invite(writer, role, role, "local"), "hash")
        yield role, (b"cookie", f"{cookie}={access.open_session(writer, role, 'password')}".encode())
    for scope in SCOPES:
        yield f"token {scope}", _bearer(access.create_token(writer, f"t-{scope}", "admin", scope))
    # A token that was made when its owner had a higher role.
    made = access.create_token(writer, "t-demoted", "admin", "admin")
    writer.execute(sa.update(Token).where(Token.name == "t-demoted").values(owner="engineer"))
    yield "token of a demoted user", _bearer(made)
    yield "expired token", _bearer(access.create_token(writer, "t-expired", "admin", "admin", -1.0))
    yield "revoked token", _bearer(access.create_token(writer, "t-revoked", "admin", "admin"))
    access.revoke_token(writer, "t-revoked")
    users.accept(writer, users.invite(writer, "gone", "admin", "local"), "hash")
    yield "token of a disabled user", _bearer(access.create_token(writer, "t-gone", "gone", "admin"))
    users.set_disabled(writer, "gone", True)
    # A session that was opened while the user was disabled, as by a concurrent request.
    yield "disabled", (b"cookie", f"{cookie}={access.open_session(writer, 'gone', 'password')}".encode())
    yield "nobody", (b"x-nobody", b"1")
    yield "wrong cookie", (b"cookie", f"{cookie}=wrong".encode())


def _bearer(secret: str) -> tuple[bytes, bytes]:
    return b"authorization", f"Bearer {secret}".encode()


async def asked(desk: Desk, key: routes.Key, visitor: str, origin: bytes | None = None) -> int:
    """The status with which the guard refuses a request; 0 if it lets it in."""
    method, path = key
    socket = method == "SOCKET"
    headers = [(b"host", HOST), desk.visitors[visitor]]
    headers += [] if origin is None else [(b"origin", origin)]
    scope: dict[str, Any] = {
        "type": "websocket" if socket else "http", "method": method, "path": filled(path), "query_string": b"",
        "headers": headers, "app": desk.app, "state": {}, "entered": [],
    }  # fmt: skip
    sent: list[dict[str, Any]] = []

    async def receive() -> dict[str, Any]:
        return {"type": "websocket.connect" if socket else "http.request"}

    async def send(message: dict[str, Any]) -> None:
        sent.append(message)

    await desk.guard(scope, receive, send)
    if scope["entered"]:
        assert not sent
        return 0
    return 403 if sent[0]["type"] == "websocket.close" else int(sent[0]["status"])


def expected(rule: Rule, visitor: str) -> bool:
    """Whether the table permits it, spelled out apart from the code."""
    role, _, scope = visitor.partition("token ")
    if rule.role is None:
        return True
    if scope == "of a demoted user":
        role, scope = "engineer", "admin"
    elif scope in SCOPES:
        role = "admin"
    if role not in ROLES:
        return False
    enough = list(ROLES).index(role) >= list(ROLES).index(rule.role)
    if not scope:
        return enough
    return enough and rule.scope is not None and list(SCOPES).index(scope) >= list(SCOPES).index(rule.scope)


def test_every_route_and_every_visitor(desk: Desk) -> None:
    origin = b"http://" + HOST

    async def all_of_them() -> list[tuple[str, ...]]:
        wrong = []
        for key, rule in RULES.items():
            for visitor in desk.visitors:
                status = await asked(desk, key, visitor, origin)
                if (status == 0) != expected(rule, visitor) or status not in (0, 401, 403):
                    wrong.append((*key, visitor, str(status)))
        return wrong

    assert asyncio.run(all_of_them()) == []


@pytest.mark.nightly
def test_no_write_and_no_socket_from_a_foreign_origin(desk: Desk) -> None:
    async def all_of_them() -> list[tuple[str, ...]]:
        wrong = []
        for key in RULES:
            for visitor in ("admin", "token admin", "nobody"):
                for origin in (b"https://evil.example", b"null", b""):
                    status = await asked(desk, key, visitor, origin)
                    if status == 0 and key[0] != "GET":
                        wrong.append((*key, visitor, str(origin)))
        return wrong

    assert asyncio.run(all_of_them()) == []


def test_a_socket_of_a_browser_needs_an_origin(desk: Desk) -> None:
    key: routes.Key = ("SOCKET", "/view/{run}")
    assert asyncio.run(asked(desk, key, "admin")) == 403
    assert asyncio.run(asked(desk, key, "token admin")) == 0


WHO: dict[routes.Key, Role] = {
    ("POST", "/api/v1/runs"): "engineer",
    ("POST", "/api/v1/runs/{run}/flights"): "engineer",
    ("PATCH", "/api/v1/runs/{run}"): "engineer",
    ("POST", "/api/v1/runs/{run}/signoffs"): "reviewer",
    ("DELETE", "/api/v1/runs/{run}"): "admin",
    ("POST", "/api/v1/runs/remove"): "admin",
    ("POST", "/api/v1/users"): "admin",
    ("PATCH", "/api/v1/settings"): "admin",
    ("GET", "/api/v1/audit"): "reviewer",
    ("GET", "/api/v1/audit/export"): "reviewer",
    ("GET", "/api/v1/runs"): "viewer",
    ("GET", "/view/{run}/{rest:path}"): "viewer",
    ("GET", "/{path:path}"): "viewer",
}


@pytest.mark.parametrize(("key", "role"), WHO.items(), ids=lambda v: " ".join(v) if isinstance(v, tuple) else v)
def test_the_roles_are_those_that_were_decided(key: routes.Key, role: Role) -> None:
    assert RULES[key].role == role


def test_only_health_the_schema_and_signing_in_are_open() -> None:
    assert {f"{method} {path}" for (method, path), rule in RULES.items() if rule.role is None} == {
        *(
            *(f"GET {place}/health{rest}" for place in ("/api/v1", "") for rest in ("", "/live", "/ready")),
            "GET /api/v1/campaigns/schema",
            "GET /login",
            "POST /login",
            "GET /invite",
            "POST /invite",
        ),
        *("GET /login/provider", "GET /login/provider/return"),
    }


def test_no_write_is_for_viewers_but_what_is_their_own() -> None:
    harmless = {"/api/v1/campaigns/check", "/api/v1/runs/{run}/views/{key}", "/api/v1/session"}
    harmless |= {"/api/v1/runs/{run}/reweighted"}
    for (method, path), rule in RULES.items():
        if method in ("POST", "PUT", "PATCH", "DELETE") and rule.role == "viewer" and path not in harmless:
            assert path.startswith(("/api/v1/session", "/api/v1/tokens")), path
            assert rule.scope in (None, "admin"), path


def test_files_of_the_pages_are_open_and_no_other_path_is_by_looking_like_one(desk: Desk) -> None:
    of = desk.app.state.rules.of

    def role(path: str, kind: str = "http", method: str = "GET") -> str | None:
        found: Rule = of({"type": kind, "path": path, "method": method})
        return found.role

    assert {role(path) for path in ("/assets/x.js", "/favicon.ico", "/favicon.svg")} == {None}
    for path in ("/assets", "/Assets/x", "//assets/x", "/favicon.ico/", "/runs", "/api/v1/assets/x", "/api/assets/x"):
        assert role(path) == "viewer", path
    assert role("/api/v1/users/", method="POST") == "viewer", "no such route: it is answered with 404 or 405"
    assert role("/assets/x.js", method="POST") == "viewer"
    assert role("/login", method="DELETE") == "viewer"
    assert role("/login", kind="websocket") == "viewer"
    assert role("/api/v1/audit", method="HEAD") == "reviewer"


def test_the_framework_selects_the_same_route(desk: Desk) -> None:
    rules: Rules = desk.app.state.rules
    for method, path in RULES:
        assert rules.path_of(method, filled(path)) == selected(desk.app, method, filled(path)), (method, path)


def selected(app: FastAPI, method: Method, path: str) -> str:
    """The route that the framework selects."""
    scope = {"type": "websocket" if method == "SOCKET" else "http", "method": method, "path": path, "headers": []}
    for route in app.router.routes:
        if route.matches(scope)[0] == Match.FULL:
            if isinstance(route, routing._IncludedRouter):
                return str(_inner(route, scope))
            return str(getattr(route, "path", ""))
    raise AssertionError(f"no route for {method} {path}")


def _inner(router: routing._IncludedRouter, scope: dict[str, Any]) -> str:
    _, _, route, _ = router._match(scope)
    if isinstance(route, routing._IncludedRouter):
        return _inner(route, scope)
    return router.include_context.prefix + str(getattr(route, "path", ""))


def test_a_route_without_a_rule_and_a_rule_without_a_route_are_refused(desk: Desk) -> None:
    router = APIRouter()
    router.add_api_route("/new", lambda: None, methods=["GET", "DELETE"])
    app = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)
    app.include_router(router, prefix="/api/v1")
    with pytest.raises(MissingRuleError, match=r"DELETE /api/v1/new; .* GET /api/v1/new"):
        Rules(app.router.routes, {})
    with pytest.raises(MissingRuleError, match="GET /old"):
        Rules([], {("GET", "/old"): RULES["GET", "/login"]})
    with pytest.raises(MissingRuleError, match="Mount '/files'"):
        Rules([Mount("/files", app=app)], {})


def test_the_document_shows_the_table() -> None:
    assert table() in DOCUMENT.read_text(encoding="utf-8"), "run `python -m backend.access.rule_table`"
