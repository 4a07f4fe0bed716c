"""An export is one file: the list of a run's files, the route, the API's description and its client follow from it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from backend.exports.format import known, named
from backend.scenes.recordings import recording
from tests.faults.processes import REPOSITORY
from tests.given.finished_runs import finish
from tests.given.service import Service
from tests.given.submissions import submit

TEXT = '''"""The name of a run."""
from backend.exports.format import Format, whole, words
from backend.runs import service as runs

def content(reader, run_id):
    return runs.summary(reader, run_id).name.encode()

export = Format(
    file="name.txt", order=20, media_type="text/x-name", words=words("Name", "The name alone"),
    made=lambda engine, run_id: whole(engine, run_id, content),
)
'''
SHOW = """
import json
from tools import openapi
from backend.access.rules import RULES
from backend.exports.format import known, named
operation = json.loads(openapi.text())["paths"]["/api/v1/runs/{run}/exports/{file}"]["get"]
print(json.dumps({
    "last": known()[-1].file, "label": named("name.txt")[1], "media": list(operation["responses"]["200"]["content"]),
    "client": operation["responses"]["200"]["description"],
}))
"""


@pytest.mark.nightly  # by day what is listed of the formats that there are is served: the test below
def test_one_file_is_listed_served_and_described(tmp_path: Path) -> None:
    source = tmp_path / "source"
    for folder in ("backend", "campaigns", "tools"):
        shutil.copytree(REPOSITORY / folder, source / folder)
    (source / "backend" / "exports" / "formats" / "name_txt.py").write_text(TEXT, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(source)}
    command = [sys.executable, "-c", SHOW]
    done = subprocess.run(command, cwd=source, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["last"], found["label"]) == ("name.txt", "")
    assert "text/x-name" in found["media"]
    assert "name.txt" in found["client"]


def test_what_a_run_lists_is_what_is_served(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "RATE", 0.2)  # few frames: making a recording takes a second otherwise
    submit(client)
    finish(service)
    listed = client.get("/api/v1/runs/R-0001/exports").json()
    assert [one["file"] for one in listed][:3] == ["report.html", "report.pdf", "run.json"]
    assert len(listed) == len(known())
    for one in listed[2:]:
        assert one["href"].endswith(f"/exports/{one['file']}")
        answer = client.head(one["href"]) if one["unavailable"] is None else None
        assert answer is None or answer.headers["content-type"].startswith(one["media_type"])


@pytest.mark.parametrize(
    "file", ["passwd", "capsule-F1.zip.zip", "capsule-.zip", "flight-../x.html", "report.html", ""]
)
def test_another_name_is_no_export(file: str) -> None:
    assert named(file) is None
