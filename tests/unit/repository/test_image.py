"""The container image has no tools of the tests, and a release names its base images with their digests."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tools.image_packages import NOT_IN_IMAGE, ROOT, names

TOOLS = {"schemathesis", "pip-audit", "cyclonedx-python-lib", "types-pyyaml", "mypy", "pytest", "playwright", "ruff"}


def test_it_has_what_the_project_needs_and_no_tools_of_tests() -> None:
    listed = set((ROOT / "tools" / "image-packages.txt").read_text(encoding="utf-8").split())
    assert listed == names(), "run `python -m tools.generated`"
    assert not listed & TOOLS
    assert {"fastapi", "numba", "viser", "psycopg", "psycopg-binary", "authlib", "setuptools"} <= listed
    assert {"test"} <= NOT_IN_IMAGE


def test_every_one_is_locked() -> None:
    found = subprocess.run([ROOT / "tools" / "locked.sh", "--only", *(f"{name}==" for name in names())],
                           capture_output=True, text=True, check=True)  # fmt: skip
    locked = {re.split("==", line)[0].lower().replace("_", "-") for line in found.stdout.splitlines() if line[0] != " "}
    assert locked == names()


@pytest.mark.parametrize(
    ("image", "accepted"),
    [
        ("python:3.11-slim@sha256:" + "0a" * 32, True),
        ("python:3.11-slim", False),
        ("python@sha256:0a", False),
        ("python:3.11-slim@sha256:" + "0A" * 32, False),
    ],
)
def test_a_base_image_of_a_release_has_a_digest(image: str, accepted: bool) -> None:
    ended = subprocess.run([ROOT / "tools" / "image.sh", "pinned", image], capture_output=True, text=True)
    assert (ended.returncode == 0) == accepted
    assert accepted or "imagetools inspect" in ended.stderr


def test_the_base_images_are_arguments() -> None:
    text = (Path(ROOT) / "Dockerfile").read_text(encoding="utf-8")
    assert re.findall(r"^FROM (\S+)", text, re.M) == ["${PYTHON_IMAGE}", "${NODE_IMAGE}", "app"]
