"""What `make install` tells uv: what pip is told; and what it makes importable."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from tests.faults.processes import REPOSITORY
from tools.as_pip import options, settings

FILE = {"index-url": "https://file/simple", "extra-index-url": "\nhttps://b/simple\nhttps://c/simple", "cert": "/a.pem"}
OTHER = {"index-url": "https://download/simple", "no-index": "true"}


def listed(section: str, told: dict[str, str]) -> list[str]:
    return [f"{section}.{key}={value!r}" for key, value in told.items()]


@pytest.mark.parametrize("first", ["file", "environment"])
def test_of_pips_settings_the_environment_is_stronger_in_whatever_order_they_are_listed(first: str) -> None:
    parts = [listed("global", FILE), listed(":env:", {"index-url": "https://environment/simple"})]
    lines = [line for part in (parts if first == "file" else parts[::-1]) for line in part]
    told = settings("\n".join([*lines, *listed("download", OTHER)]))
    assert list(options(told, {})) == [
        *("--default-index", "https://environment/simple"),
        *("--index", "https://b/simple", "--index", "https://c/simple"),
    ]
    assert told["cert"] == "/a.pem"


def test_what_uv_is_told_itself_stays() -> None:
    told = settings("\n".join(listed("global", FILE | {"find-links": "/one /two"})))
    own = {"UV_DEFAULT_INDEX": "https://mine/simple"}
    assert list(options(told, own)) == ["--find-links", "/one", "--find-links", "/two"]
    assert list(options(told, own | {"UV_FIND_LINKS": "/three"})) == []


@pytest.mark.parametrize(("value", "none"), [("1", True), ("True", True), ("0", False), ("false", False), ("", False)])
def test_no_index_is_none_only_where_pip_has_none(value: str, none: bool) -> None:
    assert list(options({"no-index": value}, {})) == ["--no-index"] * none


@pytest.fixture
def index() -> Iterator[tuple[str, list[str]]]:
    """An index that has nothing: its address, and what was asked for."""
    asked: list[str] = []

    class Empty(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(self.path)
            self.send_error(404)

        def log_message(self, *_: object) -> None:
            return

    with ThreadingHTTPServer(("127.0.0.1", 0), Empty) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/simple", asked
        finally:
            server.shutdown()
            thread.join()


@pytest.mark.by_day(1)
@pytest.mark.parametrize("none", [False, True])
def test_the_real_uv_asks_the_index_of_pip_and_none_where_pip_has_none(
    index: tuple[str, list[str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, none: bool
) -> None:
    address, asked = index
    for name in ("UV_DEFAULT_INDEX", "UV_INDEX", "UV_FIND_LINKS", "PIP_FIND_LINKS", "PIP_EXTRA_INDEX_URL"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PIP_INDEX_URL", address)
    monkeypatch.setenv("PIP_NO_INDEX", "1" if none else "0")
    uv = [
        str(Path(sys.executable).with_name("uv")),
        "pip",
        "install",
        "--no-cache",
        "--target",
        str(tmp_path),
        "nothing",
    ]
    command = [sys.executable, str(REPOSITORY / "tools" / "as_pip.py"), *uv]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode != 0
    assert asked == ([] if none else ["/simple/nothing/"]), ended.stderr


def test_a_script_next_to_folders_with_the_names_of_our_packages_imports_ours(tmp_path: Path) -> None:
    """Whose repository has a folder `campaigns` keeps its own files there."""
    for name in ("backend", "campaigns", "clearance", "worker"):
        (tmp_path / name).mkdir()
    (tmp_path / "fly.py").write_text("import clearance; clearance.search", encoding="utf-8")
    without = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run([sys.executable, "fly.py"], cwd=tmp_path, env=without, check=True, timeout=60)
