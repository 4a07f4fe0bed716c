"""The container image has no tools of the tests, and its base images are named by digest."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

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


def test_the_base_images_are_named_by_digest() -> None:
    text = (Path(ROOT) / "Dockerfile").read_text(encoding="utf-8")
    assert re.findall(r"^FROM (\S+)", text, re.M) == ["${PYTHON_IMAGE}", "${NODE_IMAGE}", "app"]
    images = dict(re.findall(r"^ARG (\w+)=[a-z0-9./:_-]+@sha256:([0-9a-f]{64})$", text, re.M))
    assert images.keys() == {"PYTHON_IMAGE", "NODE_IMAGE"}
