"""Users over HTTP: invitations, passwords, roles, what is their own, tokens, sessions. One service for all tests.

Every test makes users of its own.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa
from argon2 import PasswordHasher

from backend.db import access, audit, passwords, users
from backend.db.engine import read
from backend.db.tables import Audit, Invitation, Session, Token, User
from backend.sessions.lockout import ACCOUNT, Lockout
from tests.api.conftest import Fresh, running
from tests.given.finished_runs import finish
from tests.given.joined_users import PASSWORD, accept, invited, joined, name, sign_in
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

API = "/api/v1"
NEXT = "a new good password"


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with pytest.MonkeyPatch.context() as patch, running(fresh_sqlite, tmp_path_factory.mktemp("users")) as service:
        # Tens of passwords are hashed here; `tests/unit/backend/db/test_passwords.py` tests the real cost.
        patch.setattr(passwords, "_HASHER", PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
        passwords._decoy.cache_clear()
        service.publish()
        yield service
    passwords._decoy.cache_clear()


@pytest.fixture(scope="module")
def admin(service: Service) -> Iterator[httpx.Client]:
    with service.signed_in() as client:
        yield client


@pytest.fixture(autouse=True)
def _no_pauses(service: Service) -> None:
    """All tests come from one address: each begins without failures."""
    service.app.state.lockout = Lockout(lambda: 0.0)


def actions(service: Service, subject: str) -> list[str]:
    with read(service.engine) as reader:
        return list(reader.scalars(sa.select(Audit.action).where(Audit.subject == subject).order_by(Audit.id)))


def listed(admin: httpx.Client, user: str) -> dict[str, object]:
    (found,) = [one for one in admin.get(f"{API}/users").json() if one["name"] == user]
    return dict(found)


def test_the_login_link_makes_an_administrator(admin: httpx.Client) -> None:
    local = listed(admin, "local")
    assert (local["role"], local["state"], local["fixed"], local["has_password"]) == ("admin", "active", True, False)


def test_sign_ins_that_the_service_is_too_busy_for_are_no_failures(
    service: Service, admin: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other sign-ins fill the queue while the password of this one is read."""
    hashing = service.app.state.capacities.passwords

    async def full(*_: object) -> bool:
        raise hashing._busy()

    with joined(service, admin, "engineer") as (user, _), service.visitor() as client:
        with monkeypatch.context() as patched:
            patched.setattr(hashing, "run", full)
            assert [sign_in(client, user).status_code for _ in range(2 * ACCOUNT.free)] == [503] * 2 * ACCOUNT.free
        assert sign_in(client, user).status_code == 303


def test_an_invitation_is_single_use(service: Service, admin: httpx.Client) -> None:
    user = name("ada")
    path = invited(admin, user, "reviewer")
    assert listed(admin, user)["state"] == "invited"
    with service.visitor() as first, service.visitor() as second:
        assert first.head(path).status_code == 200, "a preview of the link does not use it"
        answer = accept(first, path)
        assert (answer.status_code, answer.headers["location"]) == (303, "/runs")
        assert "HttpOnly" in answer.headers["set-cookie"]
        found = first.get(f"{API}/session").json()
        assert found == {
            "user": user, "via": "password", "account": user, "role": "reviewer", "scope": None, "has_password": True,
        }  # fmt: skip
        assert second.get(path).status_code == 403
        code = path.partition("code=")[2]
        again = second.post("/invite", data={"code": code, "password": PASSWORD, "again": PASSWORD})
        assert again.status_code == 403
        assert "set-cookie" not in again.headers
    assert listed(admin, user)["state"] == "active"
    assert actions(service, user) == ["user.invited", "user.joined", "session.opened"]


@pytest.mark.parametrize(
    ("password", "again", "statement"),
    [
        ("short", "short", "12 to 200 characters"),
        ("x" * 201, "x" * 201, "12 to 200 characters"),
        (PASSWORD, PASSWORD + "x", "two passwords differ"),
        ("aaaaaaaaaaaaaaaa", "aaaaaaaaaaaaaaaa", "repeats very few"),
    ],
)
def test_a_password_that_cannot_be_used_leaves_the_invitation_open(
    service: Service, admin: httpx.Client, password: str, again: str, statement: str
) -> None:
    path = invited(admin, name("bea"), "viewer")
    code = path.partition("code=")[2]
    with service.visitor() as client:
        answer = client.post("/invite", data={"code": code, "password": password, "again": again})
        assert answer.status_code == 422
        assert statement in answer.text
        assert password not in answer.text or len(password) < 6
        assert accept(client, path).status_code == 303


def test_a_new_link_voids_the_earlier_one_and_an_expired_one_is_refused(service: Service, admin: httpx.Client) -> None:
    user = name("cyd")
    old = invited(admin, user, "viewer")
    new = admin.post(f"{API}/users/{user}/invitation").json()["path"]
    with service.visitor() as client:
        assert client.get(old).status_code == 403
        assert client.get(new).status_code == 200
        with service.engine.begin() as writer:
            writer.execute(sa.update(Invitation).where(Invitation.user == user).values(expires=1.0))
        assert client.get(new).status_code == 403


def test_a_forgotten_password_is_replaced_by_a_link_which_ends_all_sessions(
    service: Service, admin: httpx.Client
) -> None:
    with joined(service, admin, "viewer") as (user, before), service.visitor() as after:
        link = admin.post(f"{API}/users/{user}/invitation").json()["path"]
        assert accept(after, link, "another good password").status_code == 303
        problem(before.get(f"{API}/session"), 401)
        assert sign_in(before, user).status_code == 403
        assert sign_in(before, user, "another good password").status_code == 303
    done = ["user.invited", "user.joined", "session.opened", "user.link_made", "user.password_set", "session.opened"]
    assert actions(service, user)[:6] == done


def test_a_link_ends_with_a_change_of_the_password(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "viewer") as (user, client), service.visitor() as other:
        link = admin.post(f"{API}/users/{user}/invitation").json()["path"]
        assert other.get(link).status_code == 200
        given = {"current": PASSWORD, "new": NEXT}
        assert client.put(f"{API}/session/password", json=given).status_code == 204
        assert other.get(link).status_code == 403
        assert sign_in(other, user, NEXT).status_code == 303


@pytest.mark.parametrize("given", ["Ada Lovelace", "", "../x", "ada\nbea", "-ada", "é", "a" * 65, "local"])
def test_a_name_that_cannot_be_used_is_refused(admin: httpx.Client, given: str) -> None:
    answer = admin.post(f"{API}/users", json={"name": given, "role": "viewer"})
    assert answer.status_code in (409, 422)


def test_the_names_of_users_and_tokens_never_meet(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "engineer") as (user, client):
        made = admin.post(f"{API}/tokens", json={"name": user.upper(), "scope": "read"})
        assert f"{user.upper()!r} " in str(problem(made, 409, "access-conflict")["detail"])
        token = name("Nightly")
        assert client.post(f"{API}/tokens", json={"name": token, "scope": "run"}).status_code == 201
        taken = admin.post(f"{API}/users", json={"name": token, "role": "viewer"})
        assert "token" in str(problem(taken, 409)["detail"])


def test_a_wrong_password_and_an_unknown_name_are_answered_alike(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "viewer") as (user, _), service.visitor() as client:
        unknown = name("nobody")
        known = sign_in(client, user, "wrong password")
        other = sign_in(client, unknown, "wrong password")
        assert known.status_code == other.status_code == 403
        assert known.text.replace(user, "NAME") == other.text.replace(unknown, "NAME")
        assert "wrong password" not in known.text
        assert "set-cookie" not in known.headers
        for row in (User.name, Audit.user, Audit.subject):
            with read(service.engine) as reader:
                assert reader.scalar(sa.select(row).where(row == unknown)) is None, "it may be a password"
        for _ in range(2 * ACCOUNT.free):
            last = [sign_in(client, who, "wrong password") for who in (user, unknown)]
        assert [answer.status_code for answer in last] == [429, 429]
        assert [answer.headers["retry-after"] for answer in last] == ["1", "1"]
        assert sign_in(client, user).status_code == 429, "the right one waits, too: otherwise the pause would tell"
    assert actions(service, user).count("session.failed") == ACCOUNT.free


def test_a_user_without_a_password_cannot_sign_in_with_one(service: Service, admin: httpx.Client) -> None:
    user = name("dot")
    invited(admin, user, "viewer")
    with service.visitor() as client:
        for password in ("", "None", "null", PASSWORD):
            assert sign_in(client, user, password).status_code == 403
            assert sign_in(client, "local", password).status_code == 403
        problem(client.get(f"{API}/session"), 401)


def test_a_shared_link_leads_through_signing_in_back_to_itself(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "viewer") as (user, _), service.visitor(accept="text/html") as client:
        page = client.get("/runs/R-0001?finding=F2&t=1.5")
        assert page.status_code == 401
        assert 'name="next" value="/runs/R-0001?finding=F2&amp;t=1.5"' in page.text
        answer = sign_in(client, user, back="/runs/R-0001?finding=F2&t=1.5")
        assert answer.headers["location"] == "/runs/R-0001?finding=F2&t=1.5"
    with service.visitor() as client:
        for evil in ("https://evil.example/", "//evil.example", "/\\evil.example", "/\t/evil.example"):
            assert sign_in(client, user, back=evil).headers["location"] == "/runs"
        link = client.get("/login", params={"code": service.login_code(), "next": "/reports?q=x"})
        assert link.headers["location"] == "/reports?q=x"
        link = client.get("/login", params={"code": service.login_code(), "next": "//evil.example"})
        assert link.headers["location"] == "/runs"


def test_the_form_shows_no_markup_of_what_was_typed(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "viewer"), service.visitor() as client:
        answer = sign_in(client, '"><script>alert(1)</script>', "x", back='/runs?"><script>')
        assert "<script" not in answer.text
        assert "<script" not in client.get("/login", params={"next": '/runs?q="><script>'}).text
        assert "<script" not in client.get("/invite", params={"code": '"><script>'}).text


@pytest.mark.parametrize("typed", ["\0", "a\0b", "\u202e", "x" * 5000, "%", "' or 1=1 --"])
def test_a_strange_name_is_a_wrong_one(service: Service, typed: str) -> None:
    with service.visitor() as client:
        assert sign_in(client, typed, "x").status_code == 403
        assert client.get("/invite", params={"code": typed}).status_code == 403


@pytest.mark.parametrize("path", ["/login", "/invite"])
def test_forms_are_taken_from_our_own_pages_only(service: Service, path: str) -> None:
    with service.visitor(origin="https://evil.example") as client:
        problem(client.post(path, data={"name": "local", "password": "x"}), 403)
    with service.visitor() as client:
        problem(client.post(path, json={"name": "local"}), 400)
        problem(client.post(path, content=b"name=%ff%fe", headers=FORM), 400)
        problem(client.post(path, content=b"&".join([b"a=b"] * 50), headers=FORM), 400)
        problem(client.post(path, content=b"name=" + b"x" * 20_000, headers=FORM), 400)


FORM = {"content-type": "application/x-www-form-urlencoded"}


def test_a_change_of_role_and_withdrawn_access_apply_at_once(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "engineer") as (user, client):
        made = client.post(f"{API}/tokens", json={"name": name("t"), "scope": "run"}).json()["secret"]
        with service.visitor(authorization=f"Bearer {made}") as program:
            for one in (client, program):
                assert one.post(f"{API}/drafts", json={"name": "", "text": "x"}).status_code == 201
            assert admin.patch(f"{API}/users/{user}", json={"role": "viewer"}).json()["role"] == "viewer"
            for one in (client, program):
                refused = one.post(f"{API}/drafts", json={"name": "", "text": "x"})
                assert " engineer" in str(problem(refused, 403, "role-too-low")["detail"])
                assert one.get(f"{API}/drafts").status_code == 200
            assert admin.patch(f"{API}/users/{user}", json={"disabled": True}).json()["state"] == "disabled"
            for one in (client, program):
                problem(one.get(f"{API}/drafts"), 401)
            assert sign_in(client, user).status_code == 403
            problem(admin.post(f"{API}/users/{user}/invitation"), 409)
            admin.patch(f"{API}/users/{user}", json={"disabled": False})
            assert sign_in(client, user).status_code == 303
    assert [a for a in actions(service, user) if a.startswith("user.")] == [
        *("user.invited", "user.joined", "user.role_changed", "user.disabled", "user.enabled"),
    ]


def test_an_administrator_is_never_locked_out(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "admin") as (user, other):
        for change in ({"role": "viewer"}, {"disabled": True}):
            assert "login link" in str(problem(other.patch(f"{API}/users/local", json=change), 409)["detail"])
            assert "your own" in str(problem(other.patch(f"{API}/users/{user}", json=change), 409)["detail"])
        problem(admin.patch(f"{API}/users/{user}", json={}), 422)
        problem(admin.patch(f"{API}/users/nobody-at-all", json={"role": "viewer"}), 404)
        problem(admin.patch(f"{API}/users/{user}", json={"role": "owner"}), 422)


def test_engineers_change_what_is_their_own(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "engineer") as (_, mine), joined(service, admin, "reviewer") as (_, other):
        token = mine.post(f"{API}/tokens", json={"name": name("t"), "scope": "run"}).json()["secret"]
        with service.visitor(authorization=f"Bearer {token}") as program:
            run = submit(program)  # the token's runs are its owner's
        draft = mine.post(f"{API}/drafts", json={"name": "", "text": "x"}).json()
        saved = {"name": "", "text": "y", "version": 1}
        problem(other.patch(f"{API}/runs/{run}", json={"pinned": True}), 403)
        problem(other.post(f"{API}/runs/{run}/cancel"), 403)
        problem(other.post(f"{API}/runs/cancel", json={"runs": [run]}), 403)
        problem(other.put(f"{API}/drafts/{draft['id']}", json=saved), 403)
        problem(other.delete(f"{API}/drafts/{draft['id']}"), 403)
        assert mine.get(f"{API}/runs/{run}").json()["state"] == "queued"
        assert mine.patch(f"{API}/runs/{run}", json={"pinned": True}).status_code == 200
        assert mine.put(f"{API}/drafts/{draft['id']}", json=saved).status_code == 200
        assert admin.delete(f"{API}/drafts/{draft['id']}").status_code == 204
        assert mine.post(f"{API}/runs/{run}/cancel").json()["state"] == "cancelled"
        problem(mine.delete(f"{API}/runs/{run}", params={"reason": "x"}), 403)
        assert admin.delete(f"{API}/runs/{run}", params={"reason": "x"}).status_code == 200


def test_one_run_of_another_user_among_several_leaves_all_uncancelled(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "engineer") as (_, mine), joined(service, admin, "engineer") as (_, other):
        runs = [submit(mine, seed=11), submit(other, seed=12)]
        problem(mine.post(f"{API}/runs/cancel", json={"runs": runs}), 403)
        assert {mine.get(f"{API}/runs/{run}").json()["state"] for run in runs} == {"queued"}


def test_tokens_have_owner_scope_and_end(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "engineer") as (user, client):
        wide = client.post(f"{API}/tokens", json={"name": name("t"), "scope": "admin"})
        assert " role engineer " in str(problem(wide, 409, "access-conflict")["detail"])
        token = name("t")
        made = client.post(f"{API}/tokens", json={"name": token, "scope": "read", "days": 30}).json()
        found = made["token"]
        assert (found["owner"], found["scope"], found["state"]) == (user, "read", "active")
        assert found["expires"] - found["created"] == pytest.approx(30 * 86400.0, abs=1.0)
        assert made["secret"] not in client.get(f"{API}/tokens").text
        assert [one["name"] for one in client.get(f"{API}/tokens").json()] == [token]
        assert token in [one["name"] for one in admin.get(f"{API}/tokens").json()]
        with service.visitor(authorization=f"Bearer {made['secret']}") as program:
            assert program.get(f"{API}/runs").status_code == 200
            refused = program.post(f"{API}/runs", json={"campaign": campaign()})
            assert "scope run" in str(problem(refused, 403)["detail"])
            problem(program.get(f"{API}/tokens"), 403)
            problem(program.put(f"{API}/session/password", json={"new": "x" * 20}), 403)
            with service.engine.begin() as writer:
                writer.execute(sa.update(Token).where(Token.name == token).values(expires=1.0))
            problem(program.get(f"{API}/runs"), 401)
        with joined(service, admin, "engineer") as (_, other):
            problem(other.delete(f"{API}/tokens/{token}"), 404)
        assert client.delete(f"{API}/tokens/{token}").json()["state"] == "revoked"
    assert actions(service, token) == ["token.created", "token.revoked"]


def test_sessions_are_listed_and_revoked_by_their_owner_and_by_administrators(
    service: Service, admin: httpx.Client
) -> None:
    with joined(service, admin, "viewer") as (user, one), service.visitor() as two:
        two.headers["user-agent"] = "Mozilla/5.0 (X11; Linux x86_64) Firefox/133.0"
        assert sign_in(two, user).status_code == 303
        mine = one.get(f"{API}/sessions").json()
        assert {found["user"] for found in mine} == {user}
        (here,) = [found for found in mine if found["current"]]
        (there,) = [found for found in mine if not found["current"]]
        assert there["agent"].endswith("Firefox/133.0")
        assert there["address"] == "127.0.0.1"
        assert here["last_used"] == pytest.approx(time.time(), abs=60)
        assert there["last_used"] is None, "it has sent no request yet"
        cookie = two.cookies[service.settings.cookie]
        assert cookie not in one.get(f"{API}/sessions").text
        assert {"local", user} <= {found["user"] for found in admin.get(f"{API}/sessions").json()}
        with joined(service, admin, "reviewer") as (_, other):
            problem(other.delete(f"{API}/sessions/{there['id']}"), 404)
        assert one.delete(f"{API}/sessions/{there['id']}").status_code == 204
        problem(two.get(f"{API}/session"), 401)
        assert admin.delete(f"{API}/sessions/{here['id']}").status_code == 204
        problem(one.get(f"{API}/session"), 401)
        problem(admin.delete(f"{API}/sessions/{here['id']}"), 404)
        problem(admin.delete(f"{API}/sessions/%25"), 422)


def test_changing_a_password_needs_the_current_one_and_signs_out_other_browsers(
    service: Service, admin: httpx.Client
) -> None:
    path = f"{API}/session/password"
    with joined(service, admin, "viewer") as (user, one), service.visitor() as two:
        sign_in(two, user)
        problem(one.put(path, json={"new": NEXT}), 403)
        problem(one.put(path, json={"current": "wrong", "new": NEXT}), 403)
        weak = one.put(path, json={"current": PASSWORD, "new": "short"})
        assert PASSWORD not in weak.text
        problem(weak, 422)
        assert one.put(path, json={"current": PASSWORD, "new": NEXT}).status_code == 204
        assert one.get(f"{API}/session").status_code == 200
        problem(two.get(f"{API}/session"), 401)
        assert sign_in(two, user).status_code == 403
        assert sign_in(two, user, NEXT).status_code == 303
        for _ in range(ACCOUNT.free):
            one.put(path, json={"current": "wrong", "new": NEXT})
        problem(one.put(path, json={"current": "wrong", "new": NEXT}), 429)


def test_behind_a_proxy_with_tls_the_cookie_is_sent_over_tls_only(fresh_sqlite: Fresh, tmp_path: Path) -> None:
    with running(fresh_sqlite, tmp_path, public_url="https://clearance.example") as service:
        with service.visitor(host="clearance.example") as client:
            assert "Secure" in client.get("/login", params={"code": service.login_code()}).headers["set-cookie"]
        with service.signed_in() as client:
            made = client.post(f"{API}/users", json={"name": "ada", "role": "viewer"}).json()
            assert made["address"] == "https://clearance.example"
        with service.visitor() as client:
            assert "Secure" not in client.get("/login", params={"code": service.login_code()}).headers["set-cookie"]


def test_no_secret_is_in_the_audit_trail_and_it_is_unbroken(service: Service, admin: httpx.Client) -> None:
    with joined(service, admin, "engineer") as (user, client):
        secret = client.post(f"{API}/tokens", json={"name": name("t"), "scope": "run"}).json()["secret"]
        link = admin.post(f"{API}/users/{user}/invitation").json()["path"].partition("code=")[2]
        sign_in(client, user, "a wrong password of ada")
        cookie = client.cookies[service.settings.cookie]
    with read(service.engine) as reader:
        text = "\n".join(str(row) for row in audit.rows(reader))
        tables = (User, Session, Token, Invitation)
        stored = "".join(str(reader.execute(sa.select(table.__table__)).all()) for table in tables)
        hashes = reader.scalars(sa.select(User.password).where(User.name == user)).all()
        assert audit.verified(reader).faults == []
    assert user in text
    for hidden in (PASSWORD, secret, link, cookie, "a wrong password of ada", *map(str, hashes)):
        assert hidden not in text
    for hidden in (PASSWORD, secret, link, cookie):
        assert hidden not in stored
    assert hashes[0] is not None
    assert hashes[0].startswith("$argon2id$")


@pytest.fixture
def alone(fresh_sqlite: Fresh, tmp_path: Path) -> Iterator[Service]:
    """A service of its own: sign-offs depend on whether there is more than one user."""
    with running(fresh_sqlite, tmp_path) as service:
        service.publish()
        yield service


def test_no_user_signs_off_their_own_run_unless_it_is_permitted(alone: Service) -> None:
    signed = {"role": "Independent review"}
    with alone.signed_in() as admin, joined(alone, admin, "reviewer") as (_, ada):
        token = ada.post(f"{API}/tokens", json={"name": "ada-ci", "scope": "run"}).json()["secret"]
        with alone.visitor(authorization=f"Bearer {token}") as program:
            run = submit(program)
            finish(alone)
            signoffs = f"{API}/runs/{run}/signoffs"
            digest = ada.get(signoffs).json()["digest"]
            problem(program.post(signoffs, json={**signed, "digest": digest}), 403)
        refused = problem(ada.post(signoffs, json={**signed, "digest": digest}), 403)
        assert refused["type"] == "urn:clearance:problem:own-run"
        assert ada.get(signoffs).json()["barred"] == refused["detail"], "the page says what the service would"
        with joined(alone, admin, "engineer") as (_, engineer):
            problem(engineer.post(signoffs, json={**signed, "digest": digest}), 403)
            barred = str(engineer.get(signoffs).json()["barred"])
            assert " role reviewer" in barred, "who launched nothing hears of the role alone"
        with joined(alone, admin, "reviewer") as (_, bob):
            other = bob.post(signoffs, json={**signed, "digest": digest})
            assert (other.status_code, other.json()["own"]) == (201, False)
            assert "already signed" in bob.get(signoffs).json()["barred"]
            problem(ada.post(f"{signoffs}/{other.json()['id']}/withdraw", json={"reason": "x"}), 403)
        assert admin.get(f"{API}/settings").json() == {"own_sign_offs": False}
        assert admin.patch(f"{API}/settings", json={"own_sign_offs": True}).json() == {"own_sign_offs": True}
        assert ada.get(signoffs).json()["barred"] is None
        own = ada.post(signoffs, json={**signed, "digest": digest})
        assert (own.status_code, own.json()["own"]) == (201, True)
        assert [one["own"] for one in ada.get(signoffs).json()["items"]] == [False, True]
        report = ada.get(f"{API}/runs/{run}/report.html").text
        assert report.count("data-own") == 1
        assert actions(alone, "own_sign_offs") == ["setting.changed"]


def test_while_local_is_the_only_user_it_is_permitted_and_reported(alone: Service) -> None:
    with alone.signed_in() as admin:
        assert admin.get(f"{API}/settings").json() == {"own_sign_offs": True}
        run = submit(admin)
        finish(alone)
        digest = admin.get(f"{API}/runs/{run}/signoffs").json()["digest"]
        signed = {"name": "Ada", "role": "Independent review", "digest": digest}
        assert admin.post(f"{API}/runs/{run}/signoffs", json=signed).json()["own"] is True


def test_two_acceptances_at_the_same_time_make_one_session(service: Service, admin: httpx.Client) -> None:
    user = name("eve")
    code = invited(admin, user, "viewer").partition("code=")[2]
    with service.engine.begin() as writer:
        assert users.accept(writer, code, "hash") == user
        assert users.accept(writer, code, "hash") is None
    with read(service.engine) as reader:
        assert users.invited(reader, code) is None
        assert access.sessions(reader, user) == []


def test_a_setting_that_was_chosen_stays_where_its_default_changes(fresh_sqlite: Fresh, tmp_path: Path) -> None:
    """Alone, the user may sign off own runs by default; once he has chosen so, also after another one joined."""
    with running(fresh_sqlite, tmp_path) as alone, alone.signed_in() as admin:
        for _ in range(2):
            assert admin.patch(f"{API}/settings", json={"own_sign_offs": True}).json() == {"own_sign_offs": True}
        assert actions(alone, "own_sign_offs") == ["setting.changed"]
        assert admin.post(f"{API}/users", json={"name": "ann", "role": "viewer"}).status_code == 201
        assert admin.get(f"{API}/settings").json() == {"own_sign_offs": True}
