"""The wheel: its pages and examples, installed into empty environments of all Pythons at hand and served from there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import httpx
import pytest

from clearance.cli.examples import WHERE, shipped
from tests.faults.processes import REPOSITORY, kill, started, until
from tests.faults.serving import get

pytestmark = pytest.mark.nightly  # each environment takes a minute

MINORS = (11, 12, 13, 14)


def python(minor: int) -> str:
    """A Python of that version that makes environments; empty if there is none."""
    managed = sorted(Path.home().glob(f".pyenv/versions/3.{minor}.*/bin/python"), reverse=True)
    named = [Path(found)] if (found := shutil.which(f"python3.{minor}")) else []
    for path in [Path(sys.executable), *managed, *named]:
        asked = [str(path), "-c", "import sys, venv, ensurepip; print(sys.version_info[1])"]
        done = subprocess.run(asked, capture_output=True, text=True, check=False)
        if done.stdout.strip() == str(minor):
            return str(path)
    return ""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run([REPOSITORY / "tools" / "wheel.sh", str(folder / "built")], cwd=REPOSITORY, check=True)
    (made,) = (folder / "built").glob("clearance-*.whl")
    return made


def test_it_has_the_pages_and_the_examples(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    built = {
        f.relative_to(REPOSITORY / "frontend/dist") for f in (REPOSITORY / "frontend/dist").rglob("*") if f.is_file()
    }
    pages = {Path(found) for n in names if (found := n.partition("share/clearance/pages/")[2])}
    assert pages == built
    examples = {Path(found) for n in names if (found := n.partition("share/clearance/examples/")[2])}
    assert examples == set(shipped())
    assert not [n for n in names if n.split("/")[0] in ("tests", "tools", "docs", "frontend")]


@pytest.mark.timeout(900)
@pytest.mark.parametrize("minor", MINORS)
def test_it_serves_the_dashboard_from_any_folder(wheel: Path, minor: int, tmp_path: Path) -> None:
    made_by = python(minor)
    if not made_by:
        pytest.skip(f"Python 3.{minor} is not at hand")
    home, elsewhere = tmp_path / "venv", tmp_path / "elsewhere"
    elsewhere.mkdir()
    subprocess.run([made_by, "-m", "venv", home], check=True)
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    install = [home / "bin/python", "-m", "pip", "install", "--quiet", str(wheel)]
    subprocess.run(install, cwd=elsewhere, env=clean, check=True)
    command = [
        "env",
        "-C",
        str(elsewhere),
        str(home / "bin/clearance"),
        "serve",
        "--data",
        str(tmp_path / "data"),
        "--port",
        "0",
        "--workers",
        "0",
    ]
    with started(command, tmp_path, "serve", PYTHONPATH="", CLEARANCE_THREADS="1") as service:
        until(lambda: service.link() or service.process.poll() is not None, "ready", 120)
        assert service.link(), service.text()
        assert "no built pages" not in service.text()
        with httpx.Client(base_url=service.address(), trust_env=False, timeout=20) as client:
            assert client.get(service.link()).status_code == 303
            page = client.get("/runs", headers={"accept": "text/html"}).text
            scripts = re.findall(r'(?:src|href)="[./]*(assets/[^"]+)"', page)
            assert scripts
            assert all(get(f"{service.address()}/{name}") == 200 for name in scripts)
            assert client.get("/api/v1/runs").json()["items"] == []
        kill(service.pid)
    subprocess.run([home / "bin/clearance", "examples"], cwd=elsewhere, env=clean, check=True)
    assert {f.relative_to(elsewhere / WHERE) for f in (elsewhere / WHERE).rglob("*") if f.is_file()} == set(shipped())
    code = subprocess.run(
        [home / "bin/clearance", "run", "unicycle_static", "--json"], cwd=elsewhere, env=clean, check=False,
        capture_output=True,
    ).returncode  # fmt: skip
    assert code in (0, 1, 2), "it has a verdict"
