"""Who may call which route: every route and method of the service, with its least role and its least token scope.

This table is the only place where that is decided; `backend.access.routes` enforces it and refuses to start a service
with a route that is not here. What a route does beyond that (own runs, own sign-offs) is in `backend.access.own` and in
the services. `docs/access.md` shows the table.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from backend.db.roles import Role, Scope

Method = Literal["GET", "POST", "PUT", "PATCH", "DELETE", "SOCKET"]


class Rule(NamedTuple):
    """The least role and the least token scope of a route."""

    role: Role | None
    """None: no sign-in."""
    scope: Scope | None
    """None: browser sessions only."""
    own: bool = False
    """Whether users other than administrators may call it for what is their own only."""
    framed: bool = False
    """Whether a sandboxed frame may open it, too, with a key for which a page of such a user waits."""


OPEN = Rule(None, None)
READ = Rule("viewer", "read")
FRAMED = Rule("viewer", "read", framed=True)
RUN = Rule("engineer", "run")
CHANGE_OWN = Rule("engineer", "run", own=True)
SIGN = Rule("reviewer", "admin")
SIGN_OWN = Rule("reviewer", "admin", own=True)
AUDIT = Rule("reviewer", "admin")
"""Whoever reviews must see who did what; only administrators can have a token with that scope."""
ADMIN = Rule("admin", "admin")
MINE = Rule("viewer", None)
"""What users do with their own access in the browser, such as changing their password."""
MY_ACCESS = Rule("viewer", "admin", own=True)
"""Tokens and sessions: their own; administrators all."""

API = "/api/v1"
PAGES = "/{path:path}"
"""The pages; their static files are open, see `STATIC`."""

STATIC = frozenset({"/favicon.ico", "/favicon.svg"})
STATIC_FOLDER = "/assets/"

_RUN = f"{API}/runs/{{run}}"

_READING = (
    f"{API}/openapi.json",
    *(f"{API}/{name}" for name in ("workers", "components", "events", "reports", "trends", "session", "batch")),
    *(f"{API}/campaigns{rest}" for rest in ("", "/{name}")),
    *(f"{API}/drafts", f"{API}/drafts/{{draft}}"),
    *(f"{API}/runs", f"{API}/runs/facets", _RUN),
    *(f"{_RUN}/{name}" for name in ("campaign.yaml", "stages", "components", "code", "history", "related")),
    *(f"{_RUN}/{name}" for name in ("evaluations", "coverage", "findings", "cases", "signoffs")),
    *(f"{_RUN}/{name}" for name in ("traces", "traces/{name}")),
    f"{_RUN}/most-likely-violation",
    *(f"{_RUN}/exports{rest}" for rest in ("", "/{file}")),
    *(f"{_RUN}/report.html", f"{_RUN}/report.pdf", f"{_RUN}/views/{{key}}"),
    f"{API}/simulators/{{name}}/proposal",
    *(f"{API}/requirements{rest}" for rest in ("", "/files", "/files/{file}/content")),
    *(f"{API}/requirements/export/{file}" for file in ("requirements.csv", "requirements.reqif", "matrix.csv")),
    f"{API}/requirements/export/argument.gsn.yaml",
    *(f"{API}/sweeps{rest}" for rest in ("", "/{sweep}", "/{sweep}/table.csv")),
    *("/view/{run}", "/view/{run}/{rest:path}"),
    *("/view/{run}/{flight}/recorded", "/view/{run}/{flight}/recorded/{rest:path}"),
    *("/", PAGES),
)
"""The addresses whose GET everyone who is signed in may call."""

METRICS: tuple[Method, str] = ("GET", "/metrics")

RULES: dict[tuple[Method, str], Rule] = {
    **{("GET", f"{place}/health{rest}"): OPEN for place in (API, "") for rest in ("", "/live", "/ready")},
    METRICS: READ,  # open with CLEARANCE_METRICS_OPEN=true
    # For editors, which read it without a token; it is the same in every installation of a version.
    ("GET", f"{API}/campaigns/schema"): OPEN,
    ("GET", "/login"): OPEN,
    ("POST", "/login"): OPEN,
    ("GET", "/login/provider"): OPEN,
    ("GET", "/login/provider/return"): OPEN,
    ("GET", "/invite"): OPEN,
    ("POST", "/invite"): OPEN,
    **{("GET", path): READ for path in _READING},
    ("SOCKET", "/view/{run}"): READ,
    ("SOCKET", "/view/{run}/{rest:path}"): FRAMED,
    # They change nothing but the 3D view that the caller has open, or nothing at all. What a view must simulate for a
    # change needs RUN, see `backend.scenes.control.channel`.
    ("PATCH", f"{_RUN}/views/{{key}}"): READ,
    ("POST", f"{API}/campaigns/check"): READ,
    ("POST", f"{_RUN}/reweighted"): READ,
    # Simulations on the service's machine.
    ("POST", f"{API}/campaigns/preview"): RUN,
    ("POST", f"{_RUN}/flights"): RUN,
    ("POST", f"{_RUN}/cases"): RUN,
    ("POST", f"{API}/drafts"): RUN,
    ("PUT", f"{API}/drafts/{{draft}}"): CHANGE_OWN,
    ("DELETE", f"{API}/drafts/{{draft}}"): CHANGE_OWN,
    ("POST", f"{API}/runs"): RUN,
    ("POST", f"{API}/runs/cancel"): CHANGE_OWN,
    ("PATCH", _RUN): CHANGE_OWN,
    ("POST", f"{_RUN}/cancel"): CHANGE_OWN,
    ("POST", f"{_RUN}/retry"): CHANGE_OWN,
    ("POST", f"{_RUN}/restart"): CHANGE_OWN,
    ("POST", f"{_RUN}/continuation"): CHANGE_OWN,
    ("PUT", f"{API}/requirements"): RUN,
    ("DELETE", f"{API}/requirements"): RUN,
    ("POST", f"{API}/requirements/files"): RUN,
    ("DELETE", f"{API}/requirements/files/{{file}}"): RUN,
    ("POST", f"{API}/sweeps"): RUN,
    ("POST", f"{API}/sweeps/{{sweep}}/cancel"): CHANGE_OWN,
    ("POST", f"{_RUN}/signoffs"): SIGN,
    ("POST", f"{_RUN}/signoffs/{{signoff}}/withdraw"): SIGN_OWN,
    ("POST", f"{API}/runs/remove"): ADMIN,
    ("POST", f"{API}/runs/restore"): ADMIN,
    ("DELETE", _RUN): ADMIN,
    ("POST", f"{_RUN}/restore"): ADMIN,
    ("GET", f"{API}/webhooks"): ADMIN,
    ("GET", f"{API}/webhooks/deliveries"): ADMIN,
    ("POST", f"{API}/webhooks/test"): ADMIN,
    ("DELETE", f"{API}/session"): READ,
    ("PUT", f"{API}/session/password"): MINE,
    ("GET", f"{API}/sessions"): MY_ACCESS,
    ("DELETE", f"{API}/sessions/{{session}}"): MY_ACCESS,
    ("GET", f"{API}/tokens"): MY_ACCESS,
    ("POST", f"{API}/tokens"): MY_ACCESS,
    ("DELETE", f"{API}/tokens/{{token}}"): MY_ACCESS,
    ("GET", f"{API}/users"): ADMIN,
    ("POST", f"{API}/users"): ADMIN,
    ("GET", f"{API}/users/{{user}}"): ADMIN,
    ("PATCH", f"{API}/users/{{user}}"): ADMIN,
    ("POST", f"{API}/users/{{user}}/invitation"): ADMIN,
    ("GET", f"{API}/settings"): ADMIN,
    ("PATCH", f"{API}/settings"): ADMIN,
    ("GET", f"{API}/audit"): AUDIT,
    ("GET", f"{API}/audit/export"): AUDIT,
}
