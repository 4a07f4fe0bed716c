"""The examples of `deploy/` read by nginx, Caddy and systemd themselves, and a service behind the first two.

The programs are installed from Debian where that is permitted.
"""

from __future__ import annotations

import os
import re
import shutil
import socket
import ssl
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
import websockets
from websockets.sync.client import connect

from tests.api.conftest import Fresh, running
from tests.faults.processes import REPOSITORY, started
from tests.given.finished_runs import finish
from tests.given.openapi_document import DOCUMENT, held
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.submissions import submit
from tests.given.viewer_clients import PROTOCOL, frames_until

pytestmark = pytest.mark.nightly

DEPLOY = REPOSITORY / "deploy"
HOST = "clearance.example.org"
SNI = {"sni_hostname": HOST}
PACKAGES = {"nginx": "nginx-light", "caddy": "caddy", "systemd-analyze": "systemd", "openssl": "openssl"}


def program(name: str) -> str:
    """The program; the test is skipped where it is missing and may not be installed."""
    os.environ["PATH"] += f"{os.pathsep}/usr/sbin"
    if (found := shutil.which(name)) is not None:
        return found
    apt, package = shutil.which("apt-get"), PACKAGES[name]
    if apt is None or os.geteuid() != 0:
        pytest.skip(f"{name} is not installed, and may not be (Debian: apt-get install {package})")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    words = [apt, "install", "--yes", "--no-install-recommends", package]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300, check=False, env=environment)
    if done.returncode or (found := shutil.which(name)) is None:
        pytest.skip(f"{name} is not installed, and apt-get could not install {package}: {done.stderr.strip()[-200:]}")
    return found


def read_by(words: list[str], folder: Path) -> str:
    """What a program says of its configuration, which it accepts."""
    done = subprocess.run(
        words, capture_output=True, text=True, timeout=60, check=False, env={**os.environ, "HOME": str(folder)}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


@pytest.fixture
def certificate(tmp_path: Path) -> tuple[Path, Path]:
    pem, key = tmp_path / "clearance.pem", tmp_path / "clearance.key"
    words = [program("openssl"), "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", f"/CN={HOST}"]
    read_by([*words, "-addext", f"subjectAltName=DNS:{HOST}", "-keyout", str(key), "-out", str(pem)], tmp_path)
    return pem, key


@pytest.fixture
def behind(fresh: Fresh, tmp_path: Path) -> Iterator[Service]:
    """A service as the units start it."""
    (tmp_path / "dist").mkdir()
    (tmp_path / "dist" / "index.html").write_text("<!doctype html><html><head></head><body></body></html>")
    given = {"public_url": f"https://{HOST}", "trusted_proxies": "127.0.0.1"}
    with running(fresh, tmp_path, **given) as service:
        service.publish()
        service.compare()
        yield service


def changed(text: str, changes: dict[str, str]) -> str:
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def nginx(folder: Path, port: int, to: int, certificate: tuple[Path, Path]) -> list[str]:
    """nginx with the example, on another port and with another certificate."""
    found, (pem, key) = program("nginx"), certificate
    changes = {
        "listen 443 ssl": f"listen 127.0.0.1:{port} ssl",
        "/etc/ssl/clearance.pem": str(pem),
        "/etc/ssl/clearance.key": str(key),
        "127.0.0.1:8000": f"127.0.0.1:{to}",
    }
    (folder / "example.conf").write_text(changed((DEPLOY / "nginx.conf").read_text(), changes))
    places = " ".join(
        f"{what}_temp_path {folder}/{what};" for what in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    user = "user root;" if os.geteuid() == 0 else ""
    main = f"{user} pid {folder}/nginx.pid; error_log stderr; events {{}}\n"
    (folder / "nginx.conf").write_text(f"{main}http {{ access_log off; {places} include {folder}/example.conf; }}\n")
    words = [found, "-p", str(folder), "-e", "stderr", "-c", str(folder / "nginx.conf")]
    said = read_by([*words, "-t"], folder)
    assert "syntax is ok" in said
    assert "[warn]" not in said, said
    return [*words, "-g", "daemon off;"]


def caddy(folder: Path, port: int, to: int, certificate: tuple[Path, Path]) -> list[str]:
    """Caddy with the example, likewise; it would ask for a certificate of its own."""
    found, (pem, key) = program("caddy"), certificate
    text = (DEPLOY / "Caddyfile").read_text()
    (folder / "as-it-is").write_text(text)
    read_by([found, "validate", "--adapter", "caddyfile", "--config", str(folder / "as-it-is")], folder)
    site = f"https://{HOST}:{port} {{\n\ttls {pem} {key}\n\tbind 127.0.0.1\n"
    more = changed(text, {f"{HOST} {{\n": site, "127.0.0.1:8000": f"127.0.0.1:{to}"})
    (folder / "Caddyfile").write_text(f"{{\n\tadmin off\n\tauto_https off\n}}\n{more}")
    return [found, "run", "--adapter", "caddyfile", "--config", str(folder / "Caddyfile")]


class Browser:
    """What asks through the proxy, under the public name."""

    def __init__(self, port: int) -> None:
        self.port, self.cookie = port, ""
        self._client = httpx.Client(base_url=f"https://127.0.0.1:{port}", verify=False, trust_env=False, timeout=20)

    def get(self, path: str, **query: str) -> httpx.Response:
        return self._client.get(path, params=query, headers=self._headers(path), extensions=SNI)

    def first_line(self, path: str) -> str:
        """Of a stream."""
        with self._client.stream("GET", path, headers=self._headers(path), extensions=SNI) as stream:
            return next(stream.iter_lines())

    def _headers(self, path: str) -> dict[str, str]:
        accepted = {"Host": HOST, "Accept": "*/*" if path.startswith("/api/") else "text/html"}
        return accepted | ({"Cookie": self.cookie} if self.cookie else {})

    def reached(self) -> bool:
        try:
            return self.get("/api/v1/health/live").status_code == 200
        except httpx.TransportError:
            return False

    @contextmanager
    def socket(self, path: str) -> Iterator[websockets.sync.client.ClientConnection]:
        trusting = ssl.create_default_context()
        trusting.check_hostname, trusting.verify_mode = False, ssl.CERT_NONE
        with connect(
            f"wss://{HOST}{path}",
            sock=socket.create_connection(("127.0.0.1", self.port)),
            ssl=trusting,
            server_hostname=HOST,
            additional_headers={"Cookie": self.cookie, "Origin": f"https://{HOST}"},
            subprotocols=[websockets.Subprotocol(PROTOCOL)],
            compression=None,
            max_size=None,
            proxy=None,
        ) as connection:
            yield connection


@pytest.mark.parametrize("proxy", [nginx, caddy])
def test_a_service_behind_the_example_of_a_proxy(
    proxy: object, behind: Service, certificate: tuple[Path, Path], tmp_path: Path
) -> None:
    """Health, a page, the login, a socket and a stream of events arrive; the metrics stay inside."""
    assert callable(proxy)
    port, folder = free_port(), tmp_path / "proxy"
    folder.mkdir()
    words = proxy(folder, port, behind.port, certificate)
    with started(words, tmp_path, "proxy", HOME=str(folder)) as process:
        browser = Browser(port)
        until(lambda: browser.reached() or process.process.poll() is not None)
        assert process.process.poll() is None, process.text()
        ready = browser.get("/api/v1/health/ready")
        assert ready.status_code == 200, ready.text
        held(ready, DOCUMENT["paths"]["/api/v1/health/ready"]["get"])
        assert "max-age" in ready.headers["strict-transport-security"]
        assert browser.get("/login").headers["content-type"].startswith("text/html")
        problem(browser.get("/api/v1/runs"), 401)
        assert browser.get("/metrics").status_code == 404
        login = browser.get("/login", code=behind.login_code())
        assert login.status_code == 303
        [cookie] = login.headers.get_list("set-cookie")
        assert "Secure" in cookie
        browser.cookie = cookie.partition(";")[0]
        assert browser.get("/runs").status_code == 200
        with behind.signed_in() as client:
            run = submit(client)
        finish(behind)
        assert browser.get("/api/v1/runs").json()["items"][0]["id"] == run
        assert browser.first_line("/api/v1/events") == "retry: 2000"
        with browser.socket(f"/view/{run}/") as view:
            assert view.subprotocol == PROTOCOL
            frames_until(view, b"/flights/nominal/path")


def test_units_are_accepted_by_systemd(tmp_path: Path) -> None:
    """Their program is another one, as theirs is not installed here."""
    verify = program("systemd-analyze")
    for unit in [*sorted(DEPLOY.glob("*.service")), *sorted(DEPLOY.glob("*.timer"))]:
        text = re.sub(r"/opt/clearance/bin/\w+", "/bin/true", unit.read_text()).replace("User=clearance\n", "")
        copy = tmp_path / unit.name.replace("@", "@1" if "@." in unit.name else "@")
        copy.write_text(text)
        done = subprocess.run([verify, "verify", str(copy)], capture_output=True, text=True, timeout=60, check=False)
        said = [line for line in done.stderr.splitlines() if unit.name.partition(".")[0].rstrip("@") in line]
        assert said == [], done.stderr
