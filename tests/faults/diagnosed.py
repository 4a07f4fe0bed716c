"""What `clearance doctor` says of a data folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from clearance.cli import invoke


def diagnosed(data: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, dict[str, Any]]:
    """The exit code, and what was found by its name."""
    capsys.readouterr()
    code = invoke(["doctor", "--json", "--data", str(data)])
    return code, {one["name"]: one for one in json.loads(capsys.readouterr().out)}
