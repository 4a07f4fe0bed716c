"""The text of the OpenAPI document, for what is generated from it."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from backend.app import create
from backend.settings import Settings


def text() -> str:
    with tempfile.TemporaryDirectory() as folder:
        return json.dumps(create(Settings(data=Path(folder))).openapi(), indent=2, ensure_ascii=False) + "\n"
