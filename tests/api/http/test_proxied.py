"""The service below a path and behind proxies: which headers are believed, and that every address has the path."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from backend.settings import Settings
from tests.api.conftest import Fresh, running
from tests.given.finished_runs import finish
from tests.given.service import Service
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, frames_until, viewing

ROOT = "/clearance"
HOST = "clearance.example"
FORWARDED = {"x-forwarded-for": "203.0.113.7", "x-forwarded-proto": "https", "x-forwarded-host": HOST}
OURS = {"origin": f"https://{HOST}"}
INDEX = """<!doctype html><html lang="en"><head><link rel="icon" href="./favicon.svg" />
<script src="./theme.js"></script><script type="module" crossorigin src="./assets/index-1.js"></script>
<link rel="stylesheet" href="/assets/index-1.css"></head><body></body></html>"""


def pages(folder: Path) -> None:
    (folder / "dist" / "assets").mkdir(parents=True)
    (folder / "dist" / "index.html").write_text(INDEX)
    (folder / "dist" / "assets" / "index-1.js").write_text("1")


@pytest.fixture(scope="module")
def trusting(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Below a path, behind a proxy on this machine and another one in front of it."""
    folder = tmp_path_factory.mktemp("trusting")
    pages(folder)
    given = {"public_url": f"https://{HOST}{ROOT}", "trusted_proxies": "127.0.0.1 198.51.100.0/24"}
    with running(fresh_sqlite, folder, **given) as service:
        yield service


@pytest.fixture(scope="module")
def wary(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service without a trusted proxy."""
    folder = tmp_path_factory.mktemp("wary")
    pages(folder)
    with running(fresh_sqlite, folder, trusted_proxies="198.51.100.7") as service:
        yield service


def opened(service: Service, path: str = "/login", **headers: str) -> tuple[httpx.Response, str]:
    """The answer to a login link, and the address that the session has."""
    with service.visitor(**headers) as client:
        answer = client.get(path, params={"code": service.login_code()})
        (cookie,) = answer.headers.get_list("set-cookie")
        name, _, value = cookie.partition(";")[0].partition("=")
        found = client.get("/api/v1/sessions", headers={"cookie": f"{name}={value}"}).json()
        return answer, next(str(one["address"]) for one in found if one["current"])


def test_headers_of_a_proxy_that_is_not_trusted_change_nothing(wary: Service) -> None:
    answer, address = opened(wary, **FORWARDED)
    assert address == "127.0.0.1"
    assert "Secure" not in answer.headers["set-cookie"]
    with wary.signed_in() as client:
        refused = client.post("/api/v1/tokens", json={}, headers={**FORWARDED, **OURS})
        assert refused.json()["type"] == "urn:clearance:problem:foreign-origin"


def test_headers_of_a_trusted_proxy_are_believed(trusting: Service) -> None:
    answer, address = opened(trusting, f"{ROOT}/login", **FORWARDED)
    assert address == "203.0.113.7"
    assert {"Secure", f"Path={ROOT}"} <= set(answer.headers["set-cookie"].split("; "))
    assert answer.headers["location"] == f"{ROOT}/runs"
    with trusting.signed_in() as client:
        # From the page that the browser has, not from one that has the address of this machine.
        accepted = client.post(f"{ROOT}/api/v1/tokens", json={}, headers={**FORWARDED, **OURS})
        assert accepted.status_code == 422
        refused = client.post(f"{ROOT}/api/v1/tokens", json={}, headers={**FORWARDED, "origin": trusting.url})
        assert refused.status_code == 403


@pytest.mark.parametrize(
    ("given", "address"),
    [
        ("6.6.6.6, 203.0.113.7", "203.0.113.7"),  # what a client sends is before what proxies append
        ("6.6.6.6, 203.0.113.7, 198.51.100.9", "203.0.113.7"),
        ("2001:db8::1", "2001:db8::1"),
    ],
)
def test_the_client_is_the_last_address_that_is_no_trusted_proxy(trusting: Service, given: str, address: str) -> None:
    assert opened(trusting, **{**FORWARDED, "x-forwarded-for": given})[1] == address


@pytest.mark.parametrize("host", ["evil.example, clearance.example", "clearance.example"])
def test_the_host_is_the_one_that_the_nearest_proxy_names(trusting: Service, host: str) -> None:
    with trusting.signed_in() as client:
        sent = {**FORWARDED, **OURS, "x-forwarded-host": host}
        assert client.post(f"{ROOT}/api/v1/tokens", json={}, headers=sent).status_code == 422


def test_an_invalid_host_is_ignored(trusting: Service) -> None:
    with trusting.signed_in() as client:
        sent = {**FORWARDED, "x-forwarded-host": "a b/c", "origin": trusting.url.replace("http:", "https:")}
        assert client.post(f"{ROOT}/api/v1/tokens", json={}, headers=sent).status_code == 422


def test_every_address_has_the_path(trusting: Service) -> None:
    with trusting.visitor(accept="text/html") as client:
        page = client.get(f"{ROOT}/runs?q=x")
        assert page.status_code == 401
        for address in re.findall(r"(?:href|action)=\"([^\"]+)\"|url\(([^)]+)\)", page.text):
            assert "".join(address).startswith(ROOT), address
        assert client.get(f"{ROOT}/invite?code=x").text.count(f'href="{ROOT}/login"') == 1
    with trusting.signed_in() as client:
        client.headers["accept"] = "text/html"
        for path in ("", "/"):
            assert client.get(f"{ROOT}{path}").headers["location"] == f"{ROOT}/runs"
        shown = client.get(f"{ROOT}/runs").text
        assert f'<html data-root="{ROOT}"' in shown
        assert set(re.findall(r'(?:src|href)="(.*?/)[^/"]*"', shown)) == {f"{ROOT}/", f"{ROOT}/assets/"}
        assert client.get(f"{ROOT}/assets/index-1.js").text == "1"
        assert client.get(f"{ROOT}/view/R-0001").headers["location"] == f"{ROOT}/view/R-0001/"
        gone = client.get(f"{ROOT}/api/v1/runs/R-9999", headers={"accept": "application/json"}).json()
        assert gone["instance"] == f"{ROOT}/api/v1/runs/R-9999"
        # A proxy that removes the path itself.
        assert client.get("/assets/index-1.js").text == "1"


def test_without_a_path_the_pages_are_at_the_root(wary: Service) -> None:
    with wary.signed_in() as client:
        shown = client.get("/runs/R-0001", headers={"accept": "text/html"}).text
        assert set(re.findall(r'(?:src|href)="(.*?/)[^/"]*"', shown)) == {"/", "/assets/"}
        assert client.get("/clearance/api/v1/session").status_code == 404


def test_sockets_are_below_the_path_and_from_its_pages_only(trusting: Service) -> None:
    trusting.publish()
    with trusting.signed_in() as client:
        client.base_url = f"{trusting.url}{ROOT}"  # type: ignore[assignment]
        run = submit(client)
        finish(trusting)
        path = f"{ROOT}/view/{run}/key/{KEY}/"
        with viewing(trusting, client, path, Origin=OURS["origin"], **FORWARDED) as connection:
            frames_until(connection, b"/flights/worst/path")
            assert client.get(f"/api/v1/runs/{run}/views/{KEY}").json()["flight"] == "F1"
        for wrong in ({}, {**FORWARDED, "Origin": "https://evil.example"}):
            with (
                pytest.raises(InvalidStatus, match="403"),
                viewing(trusting, client, path, **{"Origin": OURS["origin"], **wrong}),
            ):
                pass
        page = client.get(f"/view/{run}/").text
        assert f"location.replace('{ROOT}/runs/'" in page
        assert all(
            one["href"].startswith(f"{ROOT}/api/v1/") for one in client.get(f"/api/v1/runs/{run}/exports").json()
        )


@pytest.mark.parametrize(
    "given",
    [
        {"PUBLIC_URL": "clearance.example"},
        {"PUBLIC_URL": "https://clearance.example/a b"},
        {"PUBLIC_URL": "https://clearance.example//evil.example"},
        {"PUBLIC_URL": 'https://clearance.example/"><script>'},
        {"PUBLIC_URL": "https://clearance.example/../x"},
        {"PUBLIC_URL": "https://clearance.example/?x"},
        {"TRUSTED_PROXIES": "*"},
        {"TRUSTED_PROXIES": "proxy.example"},
        {"TRUSTED_PROXIES": "10.0.0.1/8"},
    ],
)
def test_wrong_settings_are_a_sentence(given: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=f"CLEARANCE_{next(iter(given))} (must|may)"):
        Settings.load({f"CLEARANCE_{name}": value for name, value in given.items()})
