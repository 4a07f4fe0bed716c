"""Simulators are edited, added and removed while a service and its worker run: nobody has to restart anything."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from backend.runs.waiting import FILES_BACK
from tests.faults.processes import REPOSITORY, until
from tests.faults.serving import Service, serving

TEXT = """
import os, pathlib, time
import clearance
from its_helper import OFFSET

@clearance.simulator(
    name={name!r}, title={title!r}, isolated=False, reads=["its_helper.py"],
    parameters={{"mass": (1.5, 2.3), "drag": (0.1, 0.2)}}, results={{"separation": clearance.Output(unit="m")}},
)
def fly(mass, drag):
    while pathlib.Path({gate!r}).exists():
        time.sleep(0.02)
    return OFFSET - 8.0 * (mass - 1.5) ** 2 - 100.0 * (drag - 0.13) ** 2
"""


class Site:
    """A service with a folder of simulators, and a browser that is signed in to it."""

    def __init__(self, service: Service, folder: Path, client: httpx.Client) -> None:
        self.service, self.folder, self.client = service, folder, client
        self.gate = folder.parent / "gate"

    def write(self, name: str, title: str = "A drop", offset: float = 60.0) -> None:
        (self.folder / "its_helper.py").write_text(f"OFFSET = {offset!r}\n", encoding="utf-8")
        text = TEXT.format(name=name, title=title, gate=str(self.gate))
        (self.folder / f"{name}.py").write_text(text, encoding="utf-8")

    def get(self, path: str) -> Any:
        answer = self.client.get(f"/api/v1{path}")
        assert answer.status_code == 200, answer.text
        return answer.json()

    def titles(self) -> dict[str, str]:
        return {one["name"]: one["title"] for one in self.get("/components").get("simulators", [])}

    def submit(self, name: str, **more: Any) -> Any:
        document = {
            "name": f"Campaign of {name}",
            "simulator": {"name": name},
            "uncertain": {"simulator.mass": {"low": 1.5, "high": 2.3}, "simulator.drag": {"low": 0.1, "high": 0.2}},
            "criterion": {"result": "separation", "threshold": 50.0, "requirements": [name]},
            "stages": {
                "search": [{"method": m, "evaluations": 200} for m in ("direct", "cma_es")],
                "validate": {"neighbours": 10, "evaluations": 20_000},
                "certify": {"samples": 100},
            },
        }
        answer = self.client.post("/api/v1/runs", json={"campaign": document, **more})
        assert answer.status_code == 201, answer.text
        return answer.json()

    def run(self, run: str) -> Any:
        return self.get(f"/runs/{run}")

    def evaluates(self, run: str) -> bool:
        """Whether its first stage has begun."""
        return any(stage["state"] == "running" for stage in self.run(run)["stages"])

    def ended(self, run: str) -> Any:
        until(lambda: self.run(run)["state"] in ("done", "failed"), f"{run} ends", 120)
        return self.run(run)

    def sign(self, run: str) -> None:
        digest = self.get(f"/runs/{run}/signoffs")["digest"]
        body = {"name": "Grace Hopper", "role": "reviewer", "digest": digest}
        assert self.client.post(f"/api/v1/runs/{run}/signoffs", json=body).status_code == 201

    def requirement(self, name: str) -> tuple[str, str]:
        (row,) = [row for row in self.get("/requirements")["items"] if row["id"] == name]
        return row["status"], row["sentence"]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    folder = tmp_path_factory.mktemp("watched")
    simulators = folder / "simulators"
    simulators.mkdir()
    environment = {"CLEARANCE_THREADS": "1", "CLEARANCE_SIMULATORS": str(simulators), "PYTHONPATH": str(REPOSITORY)}
    with serving(folder, **environment) as service:
        address, _, login = service.link().partition("/login")
        with httpx.Client(base_url=address, trust_env=False, timeout=60) as client:
            assert client.get(f"/login{login}").status_code == 303
            yield Site(service, simulators, client)


@pytest.mark.nightly  # by day the next one, and tests/e2e/test_identity.py
def test_an_edited_simulator_is_noticed_by_a_worker(site: Site) -> None:
    """From a new one to a verdict that somebody relies on, an edit, and its end."""
    assert site.titles() == {}
    site.write("a_drop")
    until(lambda: "a_drop" in site.titles(), "a new simulator is published")
    first = site.ended(site.submit("a_drop")["id"])
    assert first["verdict"] == "cleared", first
    site.sign(first["id"])
    assert site.requirement("a_drop")[0] == "met"
    again = site.submit("a_drop", reuse=True)
    assert again["id"] == first["id"]
    assert again["reused"]

    site.write("a_drop", offset=40.0)  # the helper alone: the edit is a moment old when the next request comes
    answered = site.submit("a_drop", reuse=True)
    assert (answered["reused"], answered["id"]) == (None, "R-0002"), "a file that violates is not answered with cleared"
    status, sentence = site.requirement("a_drop")
    assert status != "met", sentence
    assert site.ended("R-0002")["verdict"] == "violated"

    (site.folder / "a_drop.py").unlink()
    until(lambda: "a_drop" not in site.titles(), "a simulator that is gone is not offered")


@pytest.mark.nightly  # by day an edit of a component: tests/faults/test_code.py
def test_an_edit_while_the_worker_is_busy_is_published_and_reuses_nothing(site: Site) -> None:
    site.write("slow_drop")
    until(lambda: "slow_drop" in site.titles(), "it is published")
    first = site.ended(site.submit("slow_drop")["id"])
    assert first["verdict"] == "cleared", first
    site.sign(first["id"])
    site.gate.touch()
    busy = site.submit("slow_drop")["id"]
    until(lambda: site.evaluates(busy), "it runs")
    assert site.submit("slow_drop", reuse=True)["id"] == first["id"], "a busy worker compares its files, too"
    assert site.requirement("slow_drop")[0] == "met"
    site.write("slow_drop", title="Another drop", offset=40.0)
    assert site.submit("slow_drop", reuse=True)["reused"] is None
    until(lambda: site.titles()["slow_drop"] == "Another drop", "it is published while a run is under way")
    status, sentence = site.requirement("slow_drop")
    assert (status, "slow_drop has changed" in sentence) == ("suspect", True), sentence
    assert site.run(busy)["state"] == "running"
    site.gate.unlink()
    until(lambda: site.run(busy)["state"] == "queued", "it waits for a worker that has what it was submitted for")


@pytest.mark.nightly  # by day tests/unit/running/runs/test_files_that_change.py
def test_a_run_whose_simulator_is_edited_waits_until_the_files_are_back(site: Site) -> None:
    """Nothing that was evaluated after the edit is stored, and no attempt is spent."""
    site.gate = site.folder.parent / "another gate"  # earlier runs may still be at theirs
    site.write("edited_drop")
    until(lambda: "edited_drop" in site.titles(), "it is published")
    site.gate.touch()
    run = site.submit("edited_drop")["id"]
    until(lambda: site.evaluates(run), "it runs")
    site.write("edited_drop", offset=40.0)
    site.gate.unlink()
    until(lambda: site.run(run)["other_code"], "it waits")
    waits = site.run(run)
    assert (waits["state"], waits["error"], waits["other_code"]) == (
        "queued", None, "simulators/edited_drop has changed",
    )  # fmt: skip
    assert FILES_BACK in waits["waits"]
    site.write("edited_drop")
    ended = site.ended(run)
    assert (ended["state"], ended["verdict"], ended["attempts"]) == ("done", "cleared", 1), ended
