"""`python -m backend` as a process: settings, the link it prints, and how it ends."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import socket
import stat
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from backend.__main__ import _listen, main
from backend.settings import Settings
from tests.given.service import until

WAIT = 30.0
"""More than the service takes to begin or to end on a busy machine [s]."""


def environment(data: Path, **settings: str) -> dict[str, str]:
    own = {k: v for k, v in os.environ.items() if not k.startswith("CLEARANCE_")}
    pages = data.parent / "pages"  # without any, the service says so at start
    pages.mkdir(exist_ok=True)
    (pages / "index.html").touch()
    return {**own, "CLEARANCE_DATA": str(data), "CLEARANCE_PORT": "0", "CLEARANCE_PAGES": str(pages), **settings}


@contextmanager
def started(data: Path, **settings: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, "-m", "backend"],
        env=environment(data, **settings),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.nightly)])
def test_it_migrates_prints_a_link_serves_and_ends_before_its_streams_do(tmp_path: Path, number: int) -> None:
    """And nothing that it stores can be read by others or signs anybody in, whatever an earlier version left there."""
    data = tmp_path / "data"
    (data / "logs").mkdir(parents=True)
    for name in ("login-link", "logs/backend.log", "clearance.sqlite3"):
        (data / name).touch()
    for path in (data, *data.rglob("*")):
        path.chmod(path.stat().st_mode | 0o055)
    hooks = {"CLEARANCE_WEBHOOKS": f"http://hook:{HOOK}@127.0.0.1:9/{HOOK}", "CLEARANCE_WEBHOOK_SECRET": SIGNING}
    with started(data, **hooks, CLEARANCE_WEBHOOK_PRIVATE="true") as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("Open http://127.0.0.1:")
        link = line.removeprefix("Open ").strip()
        base = link.partition("/login")[0]
        assert (data / "service-address").read_text().strip() == base
        private(data, link.partition("code=")[2])
        with httpx.Client(base_url=base, trust_env=False, timeout=20) as client:
            first = client.get(link)
            assert (first.status_code, first.headers["location"]) == (303, "/runs"), "no code in any later address"
            assert client.get("/api/v1/runs").json()["items"] == []
            secrets = [HOOK, SIGNING, link.partition("code=")[2], *client.cookies.values(), *used(client)]
            until(lambda: client.get("/api/v1/webhooks/deliveries").json()[0]["attempts"] > 0, WAIT)
            with client.stream("GET", "/api/v1/events") as stream:
                assert next(stream.iter_lines()) == "retry: 2000"
                process.send_signal(number)
                assert process.wait(WAIT) == 0  # the stream is still open
        out, err = process.communicate()
        assert out == ""
        assert [line for line in err.splitlines() if "backend.webhooks" not in line] == []
        assert len(secrets) == 8
        stored = b"".join(path.read_bytes() for path in data.rglob("*") if path.is_file())
        for secret in secrets:
            assert len(secret) >= 12
            assert secret not in err, "in the log"
            assert secret.encode() not in stored, "in the database"


HOOK = "a-secret-part-of-an-address"
SIGNING = "whsec_MDEyMzQ1Njc4OTAxMjM0NTY3ODkwMTIzNDU2Nzg5MDE="
PASSWORD = "several words of ada"


def used(client: httpx.Client) -> list[str]:
    """Every other secret that a service handles, used once, and once wrongly."""
    token = client.post("/api/v1/tokens", json={"name": "t", "scope": "run"}).json()["secret"]
    path = client.post("/api/v1/users", json={"name": "ada", "role": "viewer"}).json()["path"]
    assert client.post("/api/v1/webhooks/test").status_code == 202
    with httpx.Client(base_url=client.base_url, trust_env=False, timeout=20) as other:
        for given in (token, f"{token}x"):
            other.get("/api/v1/runs", headers={"authorization": f"Bearer {given}"})
        code = path.partition("code=")[2]
        assert other.get(path).status_code == 200
        assert other.get(f"/invite?code={code}x").status_code == 403
        form = {"code": code, "password": PASSWORD, "again": PASSWORD}
        assert other.post("/invite", data=form).headers["location"] == "/runs"
        cookie = next(iter(other.cookies.values()))
        other.post("/login", data={"name": "ada", "password": f"{PASSWORD} wrong"})
        other.get("/login", params={"code": f"{code}y"})
    return [token, code, PASSWORD, cookie]


def private(data: Path, code: str) -> None:
    """The folder of a running service has no login link in it, and nothing that others may read."""
    assert len(code) > 40
    stored = [path for path in data.rglob("*") if path.is_file()]
    assert len(stored) >= 3
    assert not any(code.encode() in path.read_bytes() for path in stored)
    assert not (data / "login-link").exists()
    modes = {path.relative_to(data): stat.S_IMODE(path.stat().st_mode) for path in (data, *data.rglob("*"))}
    assert {path: mode for path, mode in modes.items() if mode & 0o077} == {}


@pytest.mark.nightly  # by day tests/faults/test_serve.py: no file of `clearance serve` has a link, nor has its log
def test_a_link_is_printed_only_where_it_is_wanted(tmp_path: Path) -> None:
    with started(tmp_path / "new", CLEARANCE_PRINT_LINK="false") as process:
        address = tmp_path / "new" / "service-address"
        until(address.exists, WAIT)
        with httpx.Client(base_url=address.read_text().strip(), trust_env=False) as client:
            assert client.get("/api/v1/health").status_code == 200
        process.terminate()
        assert process.communicate(timeout=WAIT) == ("", "")


Refused = Callable[..., str]


@pytest.fixture
def refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refused:
    """What the program says when it does not begin, here in this process."""

    def statement(**settings: str) -> str:
        for name, value in {"CLEARANCE_DATA": str(tmp_path), "CLEARANCE_PORT": "0", **settings}.items():
            monkeypatch.setenv(name, value)
        assert main() == 2
        return capsys.readouterr().err

    return statement


def test_a_bind_other_than_loopback_is_refused_with_a_sentence(refused: Refused, tmp_path: Path) -> None:
    statement = refused(CLEARANCE_HOST="0.0.0.0")
    assert "CLEARANCE_ALLOW_ANY_HOST=true" in statement
    assert not list(tmp_path.iterdir())


def test_a_taken_port_and_an_unknown_database_are_reported_in_a_sentence(refused: Refused) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        statement = refused(CLEARANCE_PORT=str(taken.getsockname()[1]))
    assert "cannot listen on 127.0.0.1:" in statement
    assert "mysql" in refused(CLEARANCE_DATABASE="mysql://x/y")


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1", "127.1.2.3"])
def test_loopback_needs_no_permission(host: str) -> None:
    assert Settings.load({"CLEARANCE_HOST": host}).host == host


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.5", "example.org", "127.0.0.1.example.org"])
def test_any_other_address_needs_permission(host: str) -> None:
    with pytest.raises(ValueError, match="ALLOW_ANY_HOST"):
        Settings.load({"CLEARANCE_HOST": host})
    allowed = Settings.load({"CLEARANCE_HOST": host, "CLEARANCE_ALLOW_ANY_HOST": "true"})
    assert allowed.url(80) == "http://127.0.0.1:80"


def test_settings_come_from_the_environment_and_mistakes_are_named() -> None:
    given = {
        "CLEARANCE_DATA": "/srv/x",
        "CLEARANCE_PORT": "9000",
        "CLEARANCE_PUBLIC_URL": "https://c.example/",
        "HOME": "/",
    }
    settings = Settings.load(given)
    assert settings.database_url == "sqlite:////srv/x/clearance.sqlite3"
    assert (settings.cookie, settings.url(9000)) == ("clearance_9000", "https://c.example")
    with pytest.raises(ValueError, match=r"CLEARANCE_PORT: .* given '99999'"):
        Settings.load({"CLEARANCE_PORT": "99999"})


def test_a_misspelled_setting_is_named() -> None:
    given = {
        "CLEARANCE_MAX_VIEWER": "3",
        "CLEARANCE_THREADS": "2",
        "CLEARANCE_SIMULATOR": "y",
        "CLEARANCE_DATA": "x",
        "HOME": "/",
        "CLEARANCE_XYZ": "",
    }
    assert Settings.unknown(given) == [
        "CLEARANCE_MAX_VIEWER is not a setting and has no effect: is CLEARANCE_MAX_VIEWERS meant?",
        "CLEARANCE_SIMULATOR is not a setting and has no effect: is CLEARANCE_SIMULATORS meant?",
        "CLEARANCE_XYZ is not a setting and has no effect",
    ]


def test_every_variable_of_the_code_is_known() -> None:
    """One that is read somewhere must not be called unknown."""
    root = Path(__file__).parents[3]
    files = [
        file for folder in ("backend", "worker", "campaigns", "clearance") for file in (root / folder).rglob("*.py")
    ]
    named = {
        name for file in files for name in re.findall(r"\"(CLEARANCE_[A-Z_]+)\"", file.read_text(encoding="utf-8"))
    }
    assert len(named) > 10
    assert Settings.unknown(dict.fromkeys(named, "1")) == []


def test_an_answer_does_not_wait_for_the_acknowledgement_of_its_head() -> None:
    async def undelayed() -> int:
        found: asyncio.Future[int] = asyncio.get_running_loop().create_future()

        async def serve(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            accepted = writer.get_extra_info("socket")
            found.set_result(accepted.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        async with await asyncio.start_server(serve, sock=_listen(Settings(port=0))) as server:
            _, writer = await asyncio.open_connection(*server.sockets[0].getsockname()[:2])
            option = await found
            writer.close()
            return option

    assert asyncio.run(undelayed())
