"""Signed runs of a requirement, and every place that shows a sign-off with its standing. Read `PLACES`."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Any

import httpx
import pytest
import yaml

from clearance.cli import invoke
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit

API = "/api/v1"
REQUIREMENT = "SYS-1"
_TOKENS = count(1)


def ran(service: Service, client: httpx.Client, **changes: Any) -> str:
    """A run that states the requirement by its id alone."""
    run = submit(client, criterion={"threshold": 0.5, "requirements": [REQUIREMENT]}, **changes)
    finish_fully(service)
    return run


def sign(client: httpx.Client, run: str, name: str = "Grace Hopper") -> dict[str, Any]:
    address = f"{API}/runs/{run}/signoffs"
    body = {"name": name, "role": "Review", "digest": client.get(address).json()["digest"]}
    answer = client.post(address, json=body)
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def word(client: httpx.Client, text: str) -> None:
    assert client.put(f"{API}/requirements", json={"id": REQUIREMENT, "text": text}).status_code == 200


def on_the_run(client: httpx.Client, run: str) -> str:
    return "\n".join(one["sentence"] for one in client.get(f"{API}/runs/{run}/signoffs").json()["items"])


def _in_the_run_file(client: httpx.Client, run: str) -> str:
    found = client.get(f"{API}/runs/{run}/exports/run.json").json()["signoffs"]
    return "\n".join(one["sentence"] for one in found)


def _in_the_report(client: httpx.Client, run: str) -> str:
    return client.get(f"{API}/runs/{run}/report.html").text.partition("12. Approval")[2]


def _among_the_reports(client: httpx.Client, run: str) -> str:
    (found,) = [one for one in client.get(f"{API}/reports").json()["items"] if one["run"] == run]
    return "\n".join(one["sentence"] for one in found["signoffs"])


def _in_the_matrix(client: httpx.Client, run: str) -> str:
    (row,) = client.get(f"{API}/requirements").json()["items"]
    return "\n".join(one["sentence"] for edge in row["runs"] if edge["id"] == run for one in edge["signoffs"])


def _in_the_table(client: httpx.Client, run: str) -> str:
    lines = client.get(f"{API}/requirements/export/matrix.csv").text.splitlines()
    return "\n".join(line for line in lines if f",{run}," in line)


def _in_the_argument(client: httpx.Client, run: str) -> str:
    nodes = yaml.safe_load(client.get(f"{API}/requirements/export/argument.gsn.yaml").text)
    return "\n".join(node["text"] for name, node in nodes.items() if name.endswith(run) and "claim" in node)


PLACES: dict[str, Callable[[httpx.Client, str], str]] = {
    "run": on_the_run,
    "run.json": _in_the_run_file,
    "report": _in_the_report,
    "reports": _among_the_reports,
    "matrix": _in_the_matrix,
    "matrix.csv": _in_the_table,
    "argument": _in_the_argument,
}


def by_command(service: Service, run: str, capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CLEARANCE_SERVICE", service.url)
        patch.setenv("CLEARANCE_TOKEN", service.token(f"t{next(_TOKENS)}"))
        assert invoke(["show", run]) == 0
    return capsys.readouterr().out
