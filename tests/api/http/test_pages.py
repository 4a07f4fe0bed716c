"""The built front end: deep links, caching, nothing outside its folder; and the plain page if it is not built."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import pytest

from tests.given.problem_documents import problem
from tests.given.service import Service

HTML = {"accept": "text/html,application/xhtml+xml"}


@pytest.fixture
def built(service: Service) -> Path:
    """The folder of a front end as the build leaves it."""
    folder = service.settings.pages
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<!doctype html><title>Clearance</title>")
    (folder / "assets" / "index-abc123.js").write_text("console.log(1)")
    (folder / "favicon.svg").write_text("<svg/>")
    (folder.parent / "secret.txt").write_text("secret")
    return folder


@pytest.mark.parametrize("path", ["/runs", "/runs/R-0001", "/runs/R-0001?t=3.2", "/launch", "/compare", "/index.html"])
def test_deep_links_open_the_application(built: Path, client: httpx.Client, path: str) -> None:
    answer = client.get(path, headers=HTML)
    assert (answer.status_code, answer.headers["cache-control"]) == (200, "no-cache")
    assert "Clearance" in answer.text


def test_the_root_leads_to_the_runs(built: Path, client: httpx.Client) -> None:
    answer = client.get("/", headers=HTML)
    assert (answer.status_code, answer.headers["location"]) == (307, "/runs")


def test_assets_are_public_and_cached_for_long(built: Path, service: Service) -> None:
    with service.visitor() as stranger:
        answer = stranger.get("/assets/index-abc123.js")
        assert answer.status_code == 200
        assert "immutable" in answer.headers["cache-control"]
        assert answer.headers["content-type"].startswith("text/javascript")
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert stranger.get("/favicon.svg").status_code == 200


def test_the_fonts_of_the_sign_in_page_need_no_session(built: Path, service: Service) -> None:
    for name in ("inter-latin-wght-normal-Dx4kXJAl", "jetbrains-mono-latin-wght-normal-B9CIFXIH"):
        (built / "assets" / f"{name}.woff2").write_bytes(name.encode())
    (built / "assets" / "inter-latin-ext-wght-normal-DO1Apj_S.woff2").write_bytes(b"other letters")
    with service.visitor() as visitor:
        page = visitor.get("/runs", headers=HTML)
        assert page.status_code == 401
        addresses = re.findall(r"url\((/assets/[^)]*)\)", page.text)
        answers = [visitor.get(address) for address in addresses]
    assert [answer.text[:14] for answer in answers] == ["inter-latin-wg", "jetbrains-mono"]
    assert {answer.headers["content-type"] for answer in answers} == {"font/woff2"}


def test_without_a_build_the_fonts_are_not_there(client: httpx.Client) -> None:
    problem(client.get("/assets/inter.woff2"), 404)


def test_what_the_build_has_packed_is_sent_so_to_browsers_that_take_it(built: Path, client: httpx.Client) -> None:
    (built / "assets" / "index-abc123.js.br").write_bytes(b"packed")
    for takes, sent in (("gzip, br", b"packed"), ("gzip", b"console.log(1)"), ("br;q=1", b"packed")):
        with client.stream("GET", "/assets/index-abc123.js", headers={"accept-encoding": takes}) as answer:
            assert b"".join(answer.iter_raw()) == sent
        assert answer.headers.get("content-encoding") == ("br" if sent == b"packed" else None)
        assert answer.headers["content-type"].startswith("text/javascript")
        assert answer.headers["vary"] == "Accept-Encoding"
        assert "immutable" in answer.headers["cache-control"]


@pytest.mark.parametrize("path", ["/assets/gone.js", "/assets/../secret.txt", "/assets/..%2f..%2fsecret.txt", "/api/x"])
def test_what_is_not_there_is_a_problem_and_not_the_application(built: Path, client: httpx.Client, path: str) -> None:
    answer = client.get(path, headers=HTML)
    if answer.status_code == 200:  # the client itself took the dots out of the path
        assert answer.text.startswith("<!doctype html>")
    else:
        problem(answer, 404)
    assert "secret" not in answer.text.replace("secret.txt", "")


def test_nothing_outside_the_folder_is_served(built: Path, client: httpx.Client) -> None:
    for path in ("/%2e%2e/secret.txt", "/..%2fsecret.txt", "/assets%2f..%2f..%2fsecret.txt", "/%00"):
        answer = client.get(path)
        assert answer.status_code == 404, path


def test_a_program_asking_for_a_page_that_is_not_there_gets_a_problem(built: Path, client: httpx.Client) -> None:
    problem(client.get("/runs", headers={"accept": "application/json"}), 404)


@pytest.mark.parametrize("path", ["/", "/runs"])
def test_without_built_pages_a_plain_page_explains_what_to_do(
    service: Service, client: httpx.Client, path: str
) -> None:
    answer = client.get(path, headers=HTML)
    assert answer.status_code == 503
    assert re.findall("<code>([a-zA-Z_ ]+)</code>", answer.text)[:2] == ["make wheel", "CLEARANCE_PAGES"]
    assert str(service.settings.pages) in answer.text


def test_no_built_file_needs_itself() -> None:
    # Such a circle runs code before what it needs is there: every page stays blank.
    assets = Path(__file__).parents[3] / "frontend" / "dist" / "assets"
    needs = {
        file.name: set(re.findall(r'(?:from|import)\s*"\./([^"]+\.js)"', file.read_text(encoding="utf-8")))
        for file in assets.glob("*.js")
    }
    assert len(needs) > 10, "the pages are built before they are tested"

    def reached(name: str, so_far: frozenset[str] = frozenset()) -> frozenset[str]:
        for other in needs.get(name, set()) - so_far:
            so_far = reached(other, so_far | {other})
        return so_far

    for name in needs:
        assert name not in reached(name), f"{name} needs itself by way of {', '.join(sorted(reached(name)))}"
