"""Every write of the API as a request that can be sent twice: by nature, or with a key."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import httpx

from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

API = "/api/v1"
CSV = b"id,text\nREQ-1,It keeps its distance.\n"


@dataclass(frozen=True)
class Sent:
    """A request, without its key."""

    path: str
    json: Any = None
    content: bytes | None = None
    query: dict[str, Any] = field(default_factory=dict)

    def to(self, client: httpx.Client, method: str, key: str | None = None) -> httpx.Response:
        headers = {} if key is None else {"Idempotency-Key": key}
        body: dict[str, Any] = {} if self.json is None else {"json": self.json}
        body |= {} if self.content is None else {"content": self.content}
        return client.request(method, API + self.path, params=self.query, headers=headers, **body)


def ended(client: httpx.Client) -> str:
    run = submit(client)
    client.post(f"{API}/runs/{run}/cancel")
    return f"/runs/{run}"


def removed(client: httpx.Client) -> str:
    path = ended(client)
    assert client.delete(API + path, params={"reason": "x"}).status_code == 200
    return path


def draft(client: httpx.Client) -> str:
    return f"/drafts/{client.post(f'{API}/drafts', json=DRAFT).json()['id']}"


def made(client: httpx.Client, path: str, key: str, **body: Any) -> str:
    """The place of something new."""
    answer = client.post(API + path, **body)
    assert answer.status_code == 201, answer.text
    return f"{path}/{answer.json()[key]}"


def other_session(client: httpx.Client) -> str:
    sessions = client.get(f"{API}/sessions").json()
    return next(f"/sessions/{one['id']}" for one in sessions if not one["current"])


def signed(client: httpx.Client) -> str:
    digest = client.get(f"{API}/runs/R-0002/signoffs").json()["digest"]
    body = {**_named(client), "role": "Review", "comment": "", "digest": digest}
    return f"/runs/R-0002/signoffs/{client.post(f'{API}/runs/R-0002/signoffs', json=body).json()['id']}"


def imported(client: httpx.Client) -> str:
    answer = client.post(f"{API}/requirements/files", params=FILE, content=CSV)
    return f"/requirements/files/{answer.json()['file']['id']}"


def written(client: httpx.Client) -> Sent:
    client.put(f"{API}/requirements", json=REQUIREMENT)
    return Sent("/requirements", query={"requirement": REQUIREMENT["id"]})


SWEEP = {"campaign": campaign(), "path": "avoider.d_0", "values": [1.0, 2.0, 3.0]}


def _named(client: httpx.Client, name: str = "Grace") -> dict[str, str]:
    """A name where there are no accounts."""
    account = client.get(f"{API}/runs/R-0002/signoffs").json()["signs_as"]
    return {"name": name} if account is None else {}


DRAFT = {"name": "", "text": "name:"}
FILE = {"kind": "csv", "name": "a.csv", "id_attribute": "id", "text_attribute": "text"}
REQUIREMENT = {"id": "REQ-9", "text": "It stops."}
PASSWORD = {"new": "correct horse battery staple"}
VIEW = "00000000-0000-4000-8000-000000000000"
Prepared = Callable[[httpx.Client], Sent]
NATURAL: dict[tuple[str, str], tuple[Prepared, tuple[int, int]]] = {
    ("delete", "/session"): (lambda _: Sent("/session"), (204, 401)),
    ("put", "/session/password"): (lambda _: Sent("/session/password", PASSWORD), (204, 403)),
    ("delete", "/sessions/{session}"): (lambda c: Sent(other_session(c)), (204, 404)),
    ("post", "/campaigns/check"): (lambda _: Sent("/campaigns/check", {"campaign": campaign()}), (200, 200)),
    ("post", "/campaigns/preview"): (lambda _: Sent("/campaigns/preview", {"campaign": campaign()}), (200, 200)),
    ("put", "/drafts/{draft}"): (lambda c: Sent(draft(c), {**DRAFT, "name": "x", "version": 1}), (200, 200)),
    ("delete", "/drafts/{draft}"): (lambda c: Sent(draft(c)), (204, 404)),
    ("post", "/runs/cancel"): (lambda c: Sent("/runs/cancel", {"runs": [submit(c)]}), (200, 200)),
    ("post", "/runs/remove"): (lambda c: Sent("/runs/remove", {"runs": [ended(c)[6:]], "reason": "x"}), (200, 200)),
    ("post", "/runs/restore"): (lambda c: Sent("/runs/restore", {"runs": [removed(c)[6:]]}), (200, 200)),
    ("patch", "/runs/{run}"): (lambda c: Sent(ended(c), {"name": "x", "notes": "y"}), (200, 200)),
    ("delete", "/runs/{run}"): (lambda c: Sent(ended(c), query={"reason": "x"}), (200, 200)),
    ("post", "/runs/{run}/cancel"): (lambda c: Sent(f"/runs/{submit(c)}/cancel"), (200, 200)),
    ("post", "/runs/{run}/retry"): (lambda _: Sent("/runs/R-0001/retry"), (409, 409)),
    ("post", "/runs/{run}/restart"): (lambda _: Sent("/runs/R-0001/restart"), (409, 409)),
    ("post", "/runs/{run}/continuation"): (lambda _: Sent("/runs/R-0001/continuation"), (409, 409)),
    ("post", "/runs/{run}/restore"): (lambda c: Sent(f"{removed(c)}/restore"), (200, 200)),
    ("post", "/runs/{run}/signoffs/{signoff}/withdraw"): (
        lambda c: Sent(f"{signed(c)}/withdraw", {"reason": "x"}),
        (200, 409),
    ),
    # They store nothing, see test_flights and test_cases; here they are refused.
    ("post", "/runs/{run}/flights"): (lambda _: Sent("/runs/R-0001/flights", {"finding": "F9"}), (422, 422)),
    ("post", "/runs/{run}/cases"): (lambda _: Sent("/runs/R-0001/cases", {"finding": "F9"}), (422, 422)),
    ("post", "/runs/{run}/reweighted"): (lambda _: Sent("/runs/R-0001/reweighted", {}), (200, 200)),
    ("post", "/sweeps/{sweep}/cancel"): (
        lambda c: Sent(f"{made(c, '/sweeps', 'id', json=SWEEP)}/cancel"),
        (200, 200),
    ),
    ("patch", "/runs/{run}/views/{key}"): (lambda _: Sent(f"/runs/R-0001/views/{VIEW}", {}), (404, 404)),
    ("patch", "/users/{user}"): (
        lambda c: Sent(made(c, "/users", "user", json={"name": "ann", "role": "viewer"}), {"role": "engineer"}),
        (200, 200),
    ),
    ("patch", "/settings"): (lambda _: Sent("/settings", {"own_sign_offs": True}), (200, 200)),
    ("delete", "/tokens/{token}"): (
        lambda c: Sent(f"/tokens/{c.post(f'{API}/tokens', json=TOKEN).json()['token']['name']}"),
        (200, 200),
    ),
    ("put", "/requirements"): (lambda _: Sent("/requirements", REQUIREMENT), (200, 200)),
    ("delete", "/requirements"): (written, (204, 404)),
    ("delete", "/requirements/files/{file}"): (lambda c: Sent(imported(c)), (204, 404)),
}
"""Writes that have the same effect when repeated: the request, its status, and that of the repetition."""

ONWARD = {("post", f"/runs/{{run}}/{way}") for way in ("retry", "restart", "continuation")}
"""Writes of a run that failed or waits for its code, which take a key: see test_onward; of others they are refused."""

TOKEN = {"name": "revoked", "scope": "run"}


def signing(client: httpx.Client) -> Sent:
    digest = client.get(f"{API}/runs/R-0002/signoffs").json()["digest"]
    return Sent("/runs/R-0002/signoffs", {**_named(client, "Ada"), "role": "Review", "comment": "", "digest": digest})


def invited(client: httpx.Client) -> Sent:
    return Sent(made(client, "/users", "user", json={"name": "bob", "role": "viewer"}) + "/invitation")


KEYED: dict[tuple[str, str], Prepared] = {
    ("post", "/runs"): lambda _: Sent("/runs", {"campaign": campaign()}),
    ("post", "/sweeps"): lambda _: Sent("/sweeps", SWEEP),
    ("post", "/drafts"): lambda _: Sent("/drafts", DRAFT),
    ("post", "/runs/{run}/signoffs"): signing,
    ("post", "/webhooks/test"): lambda _: Sent("/webhooks/test"),
    ("post", "/users"): lambda _: Sent("/users", {"name": "eve", "role": "viewer"}),
    ("post", "/users/{user}/invitation"): invited,
    ("post", "/tokens"): lambda _: Sent("/tokens", {"name": "keyed", "scope": "run"}),
    ("post", "/requirements/files"): lambda _: Sent("/requirements/files", content=CSV, query=FILE),
}
"""Writes that make something each time, unless they are repeated with the same key."""
SECRET_ONES = {("post", "/users"), ("post", "/users/{user}/invitation"), ("post", "/tokens")}
"""Their answers are shown once, and stored nowhere."""
