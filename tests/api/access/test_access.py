"""Access control: login links, sessions, tokens, origins."""

from __future__ import annotations

import contextlib
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa

from backend.db import audit, users
from backend.db.access import (
    MOST_TOKENS,
    AccessError,
    Visitor,
    create_login_code,
    create_token,
    hashed,
    revoke_token,
)
from backend.db.engine import connect, read
from backend.db.tables import LoginLink, Session, Token
from backend.sessions.attempts import BURST
from tests.api.conftest import Fresh, running
from tests.given.databases import AT_NIGHT, BOTH
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign

CLOSED = [
    "/api/v1/runs",
    "/api/v1/components",
    "/api/v1/session",
    "/api/v1/events",
    "/api/v1/openapi.json",
    "/api/v1/x",
]


def test_health_is_open_and_reveals_nothing_else(still: Service) -> None:
    with still.visitor() as stranger:
        answer = stranger.get("/api/v1/health")
    assert (answer.status_code, answer.json()) == (200, {"status": "ok"})


@pytest.mark.parametrize("path", CLOSED)
def test_everything_else_is_closed(still: Service, path: str) -> None:
    with still.visitor() as stranger:
        answer = stranger.get(path)
    assert "login link" in str(problem(answer, 401)["detail"])
    assert answer.headers["www-authenticate"].startswith("Bearer")


@pytest.mark.parametrize("path", ["/", "/runs", "/runs/R-0001", "/view/R-0001/"])
def test_an_unauthenticated_page_request_explains_how_to_sign_in(still: Service, path: str) -> None:
    with still.visitor(accept="text/html") as stranger:
        answer = stranger.get(path)
    assert answer.status_code == 401
    assert "clearance login-link" in answer.text


@pytest.mark.by_day(1)
@BOTH
def test_a_login_link_is_single_use(service: Service) -> None:
    code = service.login_code()
    with service.visitor() as first:
        answer = first.get("/login", params={"code": code})
        assert (answer.status_code, answer.headers["location"]) == (303, "/runs")
        cookie = answer.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=lax" in cookie
        by_link = {"user": "local", "via": "link", "account": "local", "role": "admin", "scope": None}
        assert first.get("/api/v1/session").json() == {**by_link, "has_password": False}
    with service.visitor() as second:
        answer = second.get("/login", params={"code": code})
        assert answer.status_code == 403
        assert "clearance login-link" in answer.text
        assert "set-cookie" not in answer.headers
        problem(second.get("/api/v1/session"), 401)


@pytest.mark.parametrize("code", ["wrong", "x" * 5000, "é\0"])
def test_a_wrong_login_link_is_refused_and_recorded_without_the_code(service: Service, code: str) -> None:
    still, before = service, service.rows()
    with still.visitor() as stranger:
        assert stranger.get("/login", params={"code": code}).status_code == 403
        assert stranger.get("/api/v1/health").status_code == 200
    until(lambda: still.rows() == before | {"audit": before["audit"] + 1})
    with read(still.engine) as reader:
        [row] = list(audit.rows(reader))[-1:]
    assert (row["user"], row["action"], row["subject"]) == ("unknown", "session.link_failed", "unknown")
    assert row["detail"] == {"address": "127.0.0.1", "attempts": 1}


@AT_NIGHT
def test_a_new_login_link_voids_the_unused_ones_before_it_and_ends_no_session(service: Service) -> None:
    with service.signed_in() as browser:
        old, new = service.login_code(), service.login_code()
        with service.visitor() as visitor:
            assert [visitor.get("/login", params={"code": code}).status_code for code in (old, new)] == [403, 303]
        assert browser.get("/api/v1/session").status_code == 200


def test_a_login_link_lives_for_a_quarter_of_an_hour(service: Service) -> None:
    with service.engine.begin() as connection:
        create_login_code(connection)
        [(created, expires)] = connection.execute(sa.select(LoginLink.created, LoginLink.expires)).all()
    assert expires - created == 900


def test_a_login_link_without_a_code_explains_where_to_find_it(still: Service) -> None:
    with still.visitor() as stranger:
        assert "clearance serve" in stranger.get("/login").text


@pytest.mark.parametrize(
    ("back", "leads"), [("/sweeps?x=1", "/sweeps?x=1"), ("https://elsewhere.example/", "/runs"), ("", "/runs")]
)
def test_who_is_signed_in_is_led_on_by_the_sign_in_page(still: Service, back: str, leads: str) -> None:
    with still.signed_in() as visitor:
        answer = visitor.get("/login", params={"next": back})
        assert (answer.status_code, answer.headers["location"]) == (303, leads)
        assert visitor.delete("/api/v1/session").status_code == 204
        assert visitor.get("/login", params={"next": back}).status_code == 200


def test_a_token_is_no_session_for_the_sign_in_page(still: Service) -> None:
    with still.visitor(authorization=f"Bearer {still.token('led-on')}") as program:
        assert program.get("/login").status_code == 200


def test_an_expired_login_link_is_refused(still: Service) -> None:
    code = still.login_code(lifetime=-1.0)
    with still.visitor() as stranger:
        assert stranger.get("/login", params={"code": code}).status_code == 403


def test_only_hashes_are_stored(service: Service) -> None:
    code, token = service.login_code(), service.token()
    with service.visitor() as visitor:
        visitor.get("/login", params={"code": code})
        secret = visitor.cookies[service.settings.cookie]
    with service.engine.connect() as connection:
        assert connection.scalar(sa.select(LoginLink.hash)) == hashed(code)
        assert connection.scalar(sa.select(Token.hash)) == hashed(token)
        assert connection.scalar(sa.select(Session.hash)) == hashed(secret)


def test_a_session_ends_when_it_expires(service: Service, client: httpx.Client) -> None:
    with service.engine.begin() as connection:
        connection.execute(sa.update(Session).values(expires=time.time() - 1))
    problem(client.get("/api/v1/session"), 401)


def test_signing_out_ends_the_session_for_good(service: Service, client: httpx.Client) -> None:
    secret = client.cookies[service.settings.cookie]
    assert client.delete("/api/v1/session").status_code == 204
    assert service.settings.cookie not in client.cookies
    with service.visitor(cookie=f"{service.settings.cookie}={secret}") as thief:
        problem(thief.get("/api/v1/session"), 401)


@AT_NIGHT
def test_a_token_signs_in_and_its_use_is_noted(service: Service) -> None:
    token = service.token("ci")
    with service.visitor(authorization=f"Bearer {token}") as program:
        by_token = {"user": "ci", "via": "token", "account": "local", "role": "admin", "scope": "admin"}
        assert program.get("/api/v1/session").json() == {**by_token, "has_password": False}
    assert until(lambda: last_used(service)) == pytest.approx(time.time(), abs=10)


def last_used(service: Service) -> float | None:
    with read(service.engine) as reader:
        return reader.scalar(sa.select(Token.last_used))


@contextmanager
def writing(engine: sa.Engine) -> Iterator[None]:
    """While a write transaction is open, as a worker's may be."""
    with engine.connect() as connection:
        connection.execute(sa.update(Token).values(created=0.0))
        try:
            yield
        finally:
            connection.rollback()


@AT_NIGHT
def test_stopping_leaves_no_connection_open_while_a_use_is_recorded(fresh: Fresh, tmp_path: Path) -> None:
    with running(fresh, tmp_path) as service:
        notes, count = service.app.state.door._notes, Counter[str]()
        for name in ("connect", "close"):
            sa.event.listen(notes, name, lambda *_, name=name: count.update([name]))
        token, beside = service.token("ci"), connect(service.settings.database_url)
        with service.visitor(authorization=f"Bearer {token}") as program, writing(beside):
            assert program.get("/api/v1/session").status_code == 200
            until(lambda: notes.pool.checkedout())
            service.stop()
        beside.dispose()
        assert count["connect"] == count["close"] == 1


@pytest.mark.by_day(1)
@BOTH
def test_authentication_does_not_wait_for_a_writer(service: Service) -> None:
    token = service.token("ci")
    with service.visitor(authorization=f"Bearer {token}") as program, writing(service.engine):
        program.timeout = httpx.Timeout(5.0)
        assert [program.get("/api/v1/session").status_code for _ in range(3)] == [200] * 3
        assert program.get("/login", params={"code": "x" * 43}).status_code == 403
        assert last_used(service) is None, "it was not noted, and nothing came of that"


@AT_NIGHT
def test_wrong_codes_are_bounded_in_number_and_a_good_one_is_taken_all_the_same(service: Service) -> None:
    looked: list[str] = []
    code = service.login_code()
    sa.event.listen(service.app.state.door._engine, "before_cursor_execute", lambda *given: looked.append(given[2]))
    with service.visitor() as stranger:
        answers = [stranger.get("/login", params={"code": f"{i:043}"}) for i in range(BURST + 30)]
        assert [a.status_code for a in answers[: BURST // 2]] == [403] * (BURST // 2)
        assert (answers[-1].status_code, answers[-1].headers["retry-after"]) == (429, "60")
        assert len([sql for sql in looked if "login_links" in sql]) < BURST + 15
        assert len([sql for sql in looked if "users" in sql]) < BURST + 15
        assert stranger.get("/login", params={"code": code}).status_code == 303
        assert stranger.get("/api/v1/session").status_code == 200
    service.stop()
    with read(service.engine) as reader:
        rows = [row["detail"]["attempts"] for row in audit.rows(reader) if row["action"] == "session.link_failed"]
    service.engine.dispose()
    assert len(rows) <= 11, "an attacker cannot fill the disk"
    assert sum(rows) == BURST + 30, "and none is left out"


def test_a_user_has_so_many_requests_open_and_others_have_theirs(fresh: Fresh, tmp_path: Path) -> None:
    """Sessions and tokens together: with a limit of their own, whoever makes many would have no limit."""
    with running(fresh, tmp_path, max_requests_each=3) as service, service.signed_in() as browser:
        with service.engine.begin() as writer:
            users.accept(writer, users.invite(writer, "ada", "viewer", "local"), "hash")
            other = create_token(writer, "ada-ci", "ada", "read")
        with browser.stream("GET", "/api/v1/events"), browser.stream("GET", "/api/v1/events"):
            refused = browser.get("/api/v1/session")
            assert "2 requests of this" in str(problem(refused, 429)["detail"])
            assert refused.headers["retry-after"] == "1"
            with service.visitor(authorization=f"Bearer {service.token('ci')}") as program:
                assert program.get("/api/v1/session").status_code == 200, "a session leaves the others something"
                with program.stream("GET", "/api/v1/events"), service.signed_in() as third:
                    assert "3 requests of your" in str(problem(third.get("/api/v1/session"), 429)["detail"])
                    with service.visitor(authorization=f"Bearer {other}") as another:
                        assert another.get("/api/v1/session").status_code == 200
        until(lambda: browser.get("/api/v1/session").status_code == 200)


def test_streams_and_views_are_limited_by_user(fresh: Fresh, tmp_path: Path) -> None:
    settings = {"max_streams_each": 2, "max_viewers_each": 1}
    with running(fresh, tmp_path, **settings) as service, contextlib.ExitStack() as stack:
        one, two, three = (
            stack.enter_context(service.visitor(authorization=f"Bearer {service.token(name)}")) for name in "abc"
        )
        for program in (one, two):
            assert stack.enter_context(program.stream("GET", "/api/v1/events")).status_code == 200
        with three.stream("GET", "/api/v1/events") as refused:
            assert refused.status_code == 429
        viewers, visitor = service.app.state.viewers, lambda key: Visitor("ci", "token", key, "ada")
        assert viewers.enter(visitor("a"))
        assert not viewers.enter(visitor("b"))
        assert "sessions and tokens" in viewers.full(visitor("b"))
    assert not service.app.state.streams.full(Visitor("a", "token", "", "local"))


def test_a_user_has_so_many_tokens(service: Service, client: httpx.Client) -> None:
    names = [f"t-{number}" for number in range(MOST_TOKENS)]
    for name in names[1:]:
        assert client.post("/api/v1/tokens", json={"name": name, "scope": "read"}).status_code == 201
    with service.engine.begin() as writer:
        create_token(writer, "expired", lifetime=-1.0)
    assert client.post("/api/v1/tokens", json={"name": names[0], "scope": "read"}).status_code == 201
    refused = problem(client.post("/api/v1/tokens", json={"name": "more", "scope": "read"}), 409)
    assert f"{MOST_TOKENS} valid tokens" in str(refused["detail"])
    client.delete(f"/api/v1/tokens/{names[0]}")
    assert client.post("/api/v1/tokens", json={"name": "more", "scope": "read"}).status_code == 201
    with service.engine.begin() as writer, pytest.raises(AccessError, match="valid tokens"):
        create_token(writer, "still-more")  # as `clearance token create` does


@pytest.mark.parametrize(
    ("public", "origin", "status"),
    [
        ("https://c.example", "https://c.example", 201),
        ("https://c.example", "http://c.example", 403),
        ("https://c.example:443", "http://c.example", 403),
        ("http://c.example", "http://c.example", 201),
        ("http://c.example", "ftp://c.example", 403),
        ("", "https://c.example", 201),
        ("https://c.example", "https://c.example/", 403),
        ("https://c.example", "https://x@c.example", 403),
    ],
)
def test_the_scheme_of_the_origin_counts(fresh: Fresh, tmp_path: Path, public: str, origin: str, status: int) -> None:
    settings = {"public_url": public, "allowed_hosts": "c.example"}
    with running(fresh, tmp_path, **settings) as service:
        headers = {"host": "c.example", "origin": origin, "authorization": f"Bearer {service.token()}"}
        with service.visitor(**headers) as program:
            assert program.post("/api/v1/drafts", json={"name": "", "text": ""}).status_code == status


@pytest.mark.parametrize("header", ["X-Forwarded-Proto: https", ""])
def test_a_trusted_proxy_states_the_scheme(fresh: Fresh, tmp_path: Path, header: str) -> None:
    with running(fresh, tmp_path, trusted_proxies="127.0.0.1") as service:
        host = f"127.0.0.1:{service.port}"
        headers = {"origin": f"http://{host}", "authorization": f"Bearer {service.token()}"}
        headers |= {"x-forwarded-proto": "https"} if header else {}
        with service.visitor(**headers) as program:
            made = program.post("/api/v1/drafts", json={"name": "", "text": ""})
            assert made.status_code == (403 if header else 201)


def test_a_token_that_is_not_valid_is_refused_as_one_whatever_the_reason(service: Service) -> None:
    revoked = service.token("ci")
    with service.engine.begin() as connection:
        revoke_token(connection, "ci")
        expired = create_token(connection, "old", "local", "read", -1.0)
    answers = {}
    for name, header in {
        "none": None, "revoked": f"Bearer {revoked}", "expired": f"bearer {expired}", "unknown": "Bearer clr_x",
        "empty": "Bearer", "another scheme": "Basic YTpi", "no scheme": revoked,
    }.items():  # fmt: skip
        with service.visitor(**({} if header is None else {"authorization": header})) as program:
            answer = program.get("/api/v1/session")
        answers[name] = (str(problem(answer, 401)["detail"]), "invalid_token" in answer.headers["www-authenticate"])
    assert answers["revoked"] == answers["expired"] == answers["unknown"] == answers["empty"]
    assert answers["another scheme"] == answers["no scheme"]
    assert len(set(answers.values())) == 3
    assert [name for name, (_, token) in answers.items() if token] == ["revoked", "expired", "unknown", "empty"]
    assert all("`clearance token" in detail for detail, _ in answers.values())
    assert not any(revoked in detail or "login-link" in detail for detail, _ in list(answers.values())[1:])


@pytest.mark.parametrize("header", ["Bearer", "Bearer wrong", "Basic YTpi", "nonsense"])
def test_a_wrong_authorization_is_refused_even_with_a_valid_cookie(
    still: Service, guest: httpx.Client, header: str
) -> None:
    problem(guest.get("/api/v1/session", headers={"authorization": header}), 401)


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1", ""])
def test_a_write_from_a_foreign_origin_is_refused_and_stores_nothing(
    still: Service, guest: httpx.Client, origin: str
) -> None:
    before = still.rows()
    answer = guest.post("/api/v1/runs", json={"campaign": campaign()}, headers={"origin": origin})
    assert "own pages" in str(problem(answer, 403)["detail"])
    assert still.rows() == before
    assert guest.get("/api/v1/health").status_code == 200


def test_a_write_from_our_own_page_is_taken(service: Service, client: httpx.Client) -> None:
    answer = client.post("/api/v1/runs", json={"campaign": campaign()}, headers={"origin": service.url})
    assert answer.status_code == 201


def test_reading_needs_no_origin(still: Service, guest: httpx.Client) -> None:
    assert guest.get("/api/v1/runs", headers={"origin": "http://evil.example"}).status_code == 200


def test_every_answer_has_a_strict_policy(still: Service, guest: httpx.Client) -> None:
    for path in ("/api/v1/health", "/api/v1/runs", "/login", "/api/v1/nothing", "/runs"):
        answer = guest.get(path)
        policy = answer.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "script-src 'self';" in policy
        assert "unsafe-eval" not in policy
        assert answer.headers["x-content-type-options"] == "nosniff"
    assert guest.get("/api/v1/runs").headers["cache-control"] == "no-store"
