"""Signing in through a real OpenID Connect provider on loopback: groups and roles, and everything that is refused.

The service is under a path, as behind a proxy.
"""

from __future__ import annotations

import re
import socket
import time
import urllib.parse
from collections.abc import Iterator
from html import unescape
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.access.rates import Bucket
from backend.db import audit, users
from backend.db.engine import read
from backend.db.tables import Audit, Session
from backend.provider import pending
from backend.provider.endpoints import BURST, PERIOD
from backend.provider.errors import SignInError, stale, unreachable
from backend.settings import Settings
from tests.api.conftest import Fresh
from tests.given.openid_provider import CLIENT, SECRET, Local, local_provider
from tests.given.problem_documents import problem
from tests.given.service import Service

ROOT = "/clearance"
API = f"{ROOT}/api/v1"
BEGIN = f"{ROOT}/login/provider"


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.fixture(scope="module")
def running_provider() -> Iterator[Local]:
    with local_provider() as local:
        yield local


@pytest.fixture
def local(running_provider: Local) -> Local:
    """The provider, as it was at the start."""
    fresh = Local(issuer=running_provider.issuer, keys=running_provider.keys)
    running_provider.__dict__.update({name: v for name, v in fresh.__dict__.items() if name != "keys"})
    return running_provider


@pytest.fixture(scope="module")
def service(
    fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory, running_provider: Local
) -> Iterator[Service]:
    folder, port = tmp_path_factory.mktemp("provider"), _free_port()
    secret = folder / "secret"
    secret.write_text(f"{SECRET}\n")
    given = {
        "CLEARANCE_DATA": str(folder / "data"),
        "CLEARANCE_DATABASE": fresh_sqlite(folder / "data"),
        "CLEARANCE_PAGES": str(folder / "dist"),
        "CLEARANCE_PORT": str(port),
        "CLEARANCE_PUBLIC_URL": f"http://127.0.0.1:{port}{ROOT}",
        "CLEARANCE_OIDC_ISSUER": running_provider.issuer,
        "CLEARANCE_OIDC_CLIENT_ID": CLIENT,
        "CLEARANCE_OIDC_CLIENT_SECRET_FILE": str(secret),
        "CLEARANCE_OIDC_NAME": "Example <ID>",
        "CLEARANCE_OIDC_ROLES": '{"eng": "engineer", "boards of review": "reviewer", "ops": "admin"}',
    }
    service = Service(Settings.load(given), port)
    service.start()
    yield service
    service.stop()


@pytest.fixture
def browser(service: Service, local: Local) -> Iterator[httpx.Client]:
    service.app.state.provider_noted = Bucket(BURST, PERIOD)
    with service.visitor(accept="text/html") as client:
        yield client


def back_from(client: httpx.Client, to: str = "") -> httpx.Response:
    """Go to the provider; its answer to the browser, which is not yet followed."""
    begun = client.get(BEGIN, params={"next": to})
    assert begun.status_code == 303, begun.text
    return client.get(begun.headers["location"])


def sign_in(client: httpx.Client, to: str = "") -> httpx.Response:
    """Go to the provider and back; the answer of the service."""
    return client.get(back_from(client, to).headers["location"])


def statement(answer: httpx.Response) -> str:
    found = re.search(r'role="alert">(.*?)</p>', answer.text)
    assert found is not None, answer.text
    return found[1]


def newest(service: Service, action: str) -> tuple[str, str, dict[str, Any]]:
    with read(service.engine) as reader:
        of = sa.select(Audit.user, Audit.via, Audit.detail).where(Audit.action == action).order_by(Audit.id.desc())
        return tuple(reader.execute(of.limit(1)).one())  # type: ignore[return-value]


def test_a_shared_link_leads_through_the_provider_to_itself(
    service: Service, browser: httpx.Client, local: Local
) -> None:
    shared = f"{ROOT}/runs/R-0001?finding=F2&t=1.5"
    page = browser.get(shared)
    assert page.status_code == 401
    (link,) = re.findall(r'class="button" href="([^"]*)">Sign in with Example &lt;ID&gt;<', page.text)
    begun = browser.get(link.replace("&amp;", "&"))
    asked = dict(urllib.parse.parse_qsl(urllib.parse.urlsplit(begun.headers["location"]).query))
    assert asked["redirect_uri"] == f"{service.url}{ROOT}/login/provider/return"
    assert (asked["response_type"], asked["code_challenge_method"]) == ("code", "S256")
    assert {len(asked[name]) for name in ("state", "nonce", "code_challenge")} == {43}
    returned = browser.get(browser.get(begun.headers["location"]).headers["location"])
    assert (returned.status_code, returned.headers["location"]) == (303, shared)
    (cookie,) = [
        one for one in returned.headers.get_list("set-cookie") if one.startswith(f"{service.settings.cookie}=")
    ]
    assert {"HttpOnly", f"Path={ROOT}", "SameSite=lax", "Max-Age=43200"} <= set(cookie.split("; "))
    found = browser.get(f"{API}/session").json()
    assert (found["user"], found["via"], found["role"], found["has_password"]) == ("ada", "provider", "engineer", False)
    assert newest(service, "user.joined")[2] == {"role": "engineer", "issuer": local.issuer, "subject": "s-1"}
    assert newest(service, "session.opened")[:2] == ("ada", "provider")
    problem(browser.put(f"{API}/session/password", json={"new": "a new good password"}), 403)


def test_the_role_follows_the_groups_and_ends_with_them(service: Service, browser: httpx.Client, local: Local) -> None:
    local.person = {"sub": "s-2", "preferred_username": "grace", "groups": ["eng", "boards of review", "x"]}
    sign_in(browser)
    assert browser.get(f"{API}/session").json()["role"] == "reviewer"
    token = browser.post(f"{API}/tokens", json={"name": "grace-ci", "scope": "run"}).json()["secret"]
    local.person["groups"] = "ops"
    with service.visitor() as other:
        assert sign_in(other).status_code == 303
        assert browser.get(f"{API}/session").json()["role"] == "admin"
        assert newest(service, "user.role_changed")[2] == {"before": "reviewer", "after": "admin"}
        mine = next(one for one in other.get(f"{API}/users").json() if one["name"] == "grace")
        assert (mine["state"], mine["created_by"], mine["provided"]) == ("active", "the sign-in provider", True)
        local.person["groups"] = ["x"]
        refused = sign_in(other)
        assert refused.status_code == 403
        assert "None of your groups" in statement(refused)
        for client in (browser, other):
            problem(client.get(f"{API}/session", headers={"accept": "application/json"}), 401)
    with service.visitor(authorization=f"Bearer {token}") as program:
        problem(program.get(f"{API}/runs"), 401)
    ended = newest(service, "user.access_ended")[2]
    assert (ended.pop("reason"), ended) == (
        newest(service, "session.failed")[2]["reason"], {"role": "admin", "sessions": 2, "tokens": 1},
    )  # fmt: skip
    local.person["groups"] = ["eng"]
    assert sign_in(browser).status_code == 303
    assert browser.get(f"{API}/session").json()["role"] == "engineer"


def test_a_name_or_an_address_takes_over_no_account(service: Service, browser: httpx.Client, local: Local) -> None:
    with service.signed_in() as admin:
        for taken in ("carol@example.org", "carol"):
            assert admin.post(f"{API}/users", json={"name": taken, "role": "admin"}).status_code == 201
        local.person = {"sub": "s-3", "email": "carol@example.org", "email_verified": True, "groups": ["eng"]}
        sign_in(browser)
        mine = browser.get(f"{API}/session").json()["user"]
        assert re.fullmatch(r"carol@example\.org-[0-9a-f]{10}", mine)
        assert browser.get(f"{API}/session").json()["role"] == "engineer"
        invited = {one["name"]: one["state"] for one in admin.get(f"{API}/users").json()}
        assert invited["carol@example.org"] == "invited"
        # The same person under another name and address is the same user; another subject with that name is not.
        local.person |= {"email": "dora@example.org", "preferred_username": "local"}
        sign_in(browser)
        assert browser.get(f"{API}/session").json()["user"] == mine
        local.person = {"sub": "s-4", "preferred_username": "local", "groups": ["eng"]}
        sign_in(browser)
        assert browser.get(f"{API}/session").json()["user"].startswith("local-")
        local.person = {"sub": "s-5", "preferred_username": "<b>\u0000Ü", "groups": ["eng"]}
        sign_in(browser)
        assert re.fullmatch(r"[a-z0-9][a-z0-9._+@-]*", browser.get(f"{API}/session").json()["user"])
        problem(admin.patch(f"{API}/users/{mine}", json={"role": "admin"}), 409)
        problem(admin.post(f"{API}/users/{mine}/invitation"), 409)
        assert admin.patch(f"{API}/users/{mine}", json={"disabled": True}).json()["state"] == "disabled"
        local.person = {"sub": "s-3", "groups": ["eng"]}
        assert "withdrawn" in statement(sign_in(browser))
        assert newest(service, "session.failed")[2]["reason"] == "disabled"


@pytest.mark.by_day(6)
@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"claims": {"nonce": "another"}}, "invalid claim: nonce"),
        ({"claims": {"nonce": None}}, "missing claim: nonce"),
        ({"claims": {"exp": 1_000_000_000}}, "expired token: exp"),
        ({"claims": {"exp": None}}, "missing claim: exp"),
        ({"claims": {"iat": 9_000_000_000, "exp": 9_000_000_300}}, "iat"),
        ({"claims": {"nbf": 9_000_000_000}}, "nbf"),
        ({"claims": {"aud": "another client"}}, "invalid claim: aud"),
        ({"claims": {"aud": [CLIENT, "another client"]}}, "missing claim: azp"),
        ({"claims": {"azp": "another client"}}, "invalid claim: azp"),
        ({"claims": {"iss": "https://other.example"}}, "invalid claim: iss"),
        ({"claims": {"at_hash": "AAAAAAAAAAAAAAAAAAAAAA"}}, "invalid claim: at_hash"),
        ({"claims": {"sub": None}}, "missing claim: sub"),
        ({"claims": {"sub": ["s-1"]}}, ""),
        ({"claims": {"sub": ""}}, ""),
        ({"claims": {"exp": "tomorrow"}}, ""),
        ({"algorithm": "none"}, ""),
        ({"algorithm": "HS256"}, ""),
        ({"algorithm": "foreign"}, "bad signature"),
        ({"returned": {"iss": "https://other.example"}}, "another issuer"),
        ({"in_token": False, "userinfo_subject": "s-9"}, "another subject"),
    ],
)
def test_an_invalid_answer_opens_no_session(
    service: Service, browser: httpx.Client, local: Local, wrong: dict[str, Any], reason: str
) -> None:
    local.__dict__.update(wrong)
    before = service.rows()["sessions"]
    refused = sign_in(browser, f"{ROOT}/runs")
    assert refused.status_code == 403
    assert reason in statement(refused)
    assert service.rows()["sessions"] == before
    assert service.settings.cookie not in browser.cookies
    user, via, detail = newest(service, "session.failed")
    assert (user, via, detail["address"]) == ("unknown", "provider", "127.0.0.1")
    assert reason in detail["reason"]


def test_a_clock_that_differs_by_less_than_a_minute_is_accepted(browser: httpx.Client, local: Local) -> None:
    at = int(time.time())
    local.claims = {"exp": at - 30, "iat": at + 30}
    assert sign_in(browser).status_code == 303
    local.claims = {"exp": at - 90}
    assert sign_in(browser).status_code == 403


def test_groups_may_be_in_the_user_information_only(browser: httpx.Client, local: Local) -> None:
    local.in_token = False
    assert sign_in(browser).status_code == 303
    assert browser.get(f"{API}/session").json()["role"] == "engineer"


def test_a_provider_may_replace_its_keys(browser: httpx.Client, local: Local, service: Service) -> None:
    assert sign_in(browser).status_code == 303
    local.renew_keys()
    local.algorithm = "ES256"
    service.app.state.provider._documents._keys_at -= 60  # a minute later
    assert sign_in(browser).status_code == 303


def test_an_answer_is_valid_once_and_in_its_own_browser(service: Service, browser: httpx.Client, local: Local) -> None:
    address = back_from(browser).headers["location"]
    cookies = dict(browser.cookies)
    with service.visitor(accept="text/html") as other:  # a link that was sent to another user
        assert statement(other.get(address)) == str(stale())
        back_from(other)
        assert statement(other.get(address)) == str(stale())
    assert browser.get(address).status_code == 303
    with service.visitor(accept="text/html") as replay:
        replay.cookies.update(cookies)
        assert statement(replay.get(address)) == str(stale())
    begun = back_from(browser).headers["location"]
    assert statement(browser.get(begun.replace("state=", "state=x")))
    assert statement(browser.get(f"{BEGIN}/return"))
    assert len(local.codes) == 2, "the provider was not asked for them"


def test_an_altered_cookie_is_refused(service: Service, browser: httpx.Client) -> None:
    address = back_from(browser).headers["location"]
    name = f"{service.settings.cookie}_signin"
    header, claims, signature = browser.cookies[name].split(".")
    for altered in ("", "x", f"{header}.{claims}.", f"{header}.{claims[:-2]}.{signature}", f"{claims}.{header}.x"):
        with service.visitor(cookie=f"{name}={altered}") as other:
            assert other.get(address).status_code == 403


def test_what_the_provider_refuses_is_a_sentence(browser: httpx.Client, local: Local) -> None:
    local.denied = True
    assert "access was denied" in statement(sign_in(browser))
    local.denied, local.returned = False, {"error": "<script>", "error_description": "x"}
    answer = sign_in(browser)
    assert (answer.status_code, "<script>" in answer.text) == (403, False)
    local.returned = {}
    back = back_from(browser).headers["location"]
    local.codes.clear()
    assert "invalid_grant" in statement(browser.get(back))


def test_a_provider_that_is_down_is_a_sentence(service: Service, browser: httpx.Client, local: Local) -> None:
    back = back_from(browser, f"{ROOT}/runs?q=x").headers["location"]
    provider = service.app.state.provider
    local.down, provider._documents._keys_at = True, -1e9
    answer = browser.get(back)
    assert (answer.status_code, answer.headers["retry-after"]) == (502, "60")
    assert unescape(statement(answer)) == str(unreachable(provider.configured.name, ""))
    provider._documents._metadata_at = -1e9
    begun = browser.get(BEGIN, params={"next": f"{ROOT}/runs?q=x"})
    assert begun.status_code == 502
    assert f"{ROOT}/login?next=%2Fclearance%2Fruns%3Fq%3Dx" in begun.text
    local.down, local.said_issuer = False, "https://other.example"
    local.answered = 0
    provider._documents._failed_at += 1e6  # just now, however long the machine took
    assert browser.get(BEGIN).status_code == 502
    assert local.answered == 0, "the failure is remembered for a moment: clients do not wait one after another"
    provider._documents._failure = None
    assert browser.get(BEGIN).status_code == 502
    assert local.answered == 1
    with service.signed_in() as admin:  # the login link needs no provider
        assert admin.get(f"{API}/session").json()["user"] == "local"
    provider._documents._failure = None


def test_failures_beyond_a_rate_are_not_recorded(service: Service, browser: httpx.Client, local: Local) -> None:
    service.app.state.provider_noted = Bucket(BURST, PERIOD, lambda: 0.0)
    local.denied = True
    before = service.rows()["audit"]
    for _ in range(BURST + 5):
        sign_in(browser)
    assert service.rows()["audit"] == before + BURST


@pytest.mark.by_day(2)
@pytest.mark.parametrize(
    "to", ["https://evil.example/", "//evil.example", "/runs", "/clearance//evil.example", "/clearancex"]
)
def test_signing_in_leads_nowhere_else(browser: httpx.Client, to: str) -> None:
    assert sign_in(browser, to).headers["location"] == f"{ROOT}/runs"


def test_no_secret_is_stored_and_the_trail_is_unbroken(service: Service, browser: httpx.Client, local: Local) -> None:
    sign_in(browser)
    with read(service.engine) as reader:
        rows = str(list(audit.rows(reader)))
        assert audit.verified(reader).faults == []
        stored = str(reader.execute(sa.select(Session.__table__)).all()) + str(users.users(reader))
    for hidden in (SECRET, "access-1", browser.cookies[service.settings.cookie], local.asked[-1]["state"]):
        assert hidden not in rows + stored


def test_many_sign_ins_neither_fill_the_memory_nor_keep_others_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pending, "MOST", 3)
    waiting = pending.Pending(lambda: 0.0)
    for _ in range(10):
        started, cookie = waiting.start("/runs")
        assert waiting.finish(cookie, started.state) == started
        with pytest.raises(SignInError):
            waiting.finish(cookie, started.state)
    assert len(waiting._used) == 3


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"ISSUER": "http://provider.example"}, "must be an https:// address"),
        ({"CLIENT_ID": ""}, "also needs CLEARANCE_OIDC_CLIENT_ID"),
        ({"SCOPES": "profile"}, "must contain openid"),
        ({"ROLES": "eng=admin"}, "JSON object"),
        ({"ROLES": '{"eng": "owner"}'}, "JSON object"),
        ({"DEFAULT_ROLE": "all"}, "one of viewer"),
        ({"CLIENT_SECRET": "x", "CLIENT_SECRET_FILE": "/dev/null"}, "both given"),
        ({"CLIENT_SECRET_FILE": "/nowhere"}, "cannot be read"),
        ({"CLIENT_SECRET_FILE": "/dev/null"}, "1 to 65536 characters"),
    ],
)
def test_wrong_settings_are_a_sentence(given: dict[str, str], sentence: str) -> None:
    right = {"ISSUER": "https://provider.example", "CLIENT_ID": "c"} | given
    named = {f"CLEARANCE_OIDC_{name}": value for name, value in right.items()}
    with pytest.raises(ValueError, match=re.escape(sentence)):
        Settings.load({"CLEARANCE_PUBLIC_URL": "https://clearance.example", **named})


def test_a_default_role_is_for_users_without_a_group_of_the_list(tmp_path: Path) -> None:
    given = {
        "ISSUER": "https://provider.example",
        "CLIENT_ID": "c",
        "DEFAULT_ROLE": "viewer",
        "ROLES": '{"a": "admin"}',
    }
    named = {f"CLEARANCE_OIDC_{name}": value for name, value in given.items()}
    provider = Settings.load({"CLEARANCE_PUBLIC_URL": "https://clearance.example", **named}).provider
    assert provider is not None
    assert [provider.role_of(groups) for groups in ((), ("x",), ("x", "a"))] == ["viewer", "viewer", "admin"]
