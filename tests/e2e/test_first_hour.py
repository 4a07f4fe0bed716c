"""The first hour with one's own robot: from an empty folder to two verdicts, with the mistakes on the way.

Commands as a newcomer types them, a service, and a browser.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from clearance.cli import invoke
from tests.e2e.browser import Visit, visiting
from tests.faults.processes import until
from tests.faults.serving import serving

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    # It compiles two robots. By day every step has a test of its own: in tests/unit/running test_own_components.py and
    # test_examination.py, tests/faults/test_code.py, and in this folder test_evidence.py and test_reading_a_run.py.
    pytest.mark.nightly,
]
DRAWS = False

MISTAKE = (
    "my_robot",
    '"kg", "Mass"',
    '"kgs", "Mass"',
    r"my_robot\.py, line \d+: MyRobot\.m: unknown unit 'kgs': did you mean",
)
"""A file, an edit of it, and the sentence; others: tests/given/component_mistakes.py."""


def campaign() -> dict[str, Any]:
    """A small campaign around the three components."""
    return {
        "name": "My robot past a post",
        "scenario": {
            "vehicle": {"component": "my_robot"},
            "controller": {"component": "my_pilot"},
            "avoider": {"component": "my_way"},
            "goal": {"x": 10.0, "y": 0.0},
            "obstacles": [{"component": "circle", "parameters": {"position": {"x": 5.0, "y": 0.4}, "radius": 0.5}}],
            "horizon": 12.0,
            "step": 0.02,
        },
        "uncertain": {"obstacles.0.position.y": {"low": 0.2, "high": 0.6, "unit": "m"}},
        "criterion": {"component": "surface_separation", "threshold": 1.0},
        "stages": {
            "sensitivity": None,
            "search": [{"method": method, "evaluations": 40} for method in ("direct", "genetic")],
            "validate": {"neighbours": 10, "evaluations": 20_000},
        },
    }


def edited(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_from_an_empty_folder_to_two_verdicts(
    tmp_path: Path, browser: Browser, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "components"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("CLEARANCE_COMPONENTS", str(folder))
    for words in (["vehicle", "my_robot"], ["controller", "my_pilot", "--for", "my_robot"], ["avoider", "my_way"]):
        assert invoke(["component", "new", *words]) == 0
    name, old, new, sentence = MISTAKE
    capsys.readouterr()
    edited(folder / f"{name}.py", old, new)
    assert invoke(["component", "check", f"{name}.py"]) == 1
    [statement] = capsys.readouterr().err.splitlines()
    assert re.search(sentence, statement), statement
    edited(folder / f"{name}.py", new, old)
    assert invoke(["component", "check", "my_way.py"]) == 0
    with (
        serving(tmp_path, CLEARANCE_COMPONENTS=str(folder)) as service,
        visiting(browser, service.address(), moving=True) as visit,
    ):
        visit.page.goto(service.link())
        in_the_browser(visit, folder)


def in_the_browser(visit: Visit, folder: Path) -> None:
    page = visit.page
    first = submitted(visit, 1)
    edited(folder / "my_way.py", "= 30.0", "= 3.0")
    (folder / "broken.py").write_text("from worker.engine.kernels.maths import kernel\n", encoding="utf-8")
    until(lambda: catalogue(visit).get("unusable"), "the catalogue is published again", 60)
    default = next(
        p["default"]
        for c in catalogue(visit)["components"]
        if (c["role"], c["name"]) == ("avoider", "my_way")
        for p in c["parameters"]
        if p["name"] == "k_away"
    )
    assert default == 3.0
    second = submitted(visit, 2)
    assert (first, second) == ("Cleared", "Violated")
    visit.go("/launch?from=R-0002")
    skipped = page.get_by_test_id("skipped")
    (broken,) = catalogue(visit)["unusable"]
    assert (broken["file"], broken["line"]) == ("components/broken.py", 1)
    expect(skipped).to_contain_text(f"{broken['file']}, line 1: {broken['text']}")
    expect(page.get_by_role("combobox", name="Vehicle, component", exact=True)).to_have_value("My robot")
    visit.shot("first-hour-launch")
    visit.move("/help/components")
    expect(page.get_by_test_id("skipped")).to_contain_text("components/broken.py")
    expect(page.get_by_role("heading", name="My way", exact=True)).to_be_visible()
    visit.shot("first-hour-components", full=False)
    visit.move("/compare?runs=R-0001,R-0002")
    expect(page.get_by_test_id("other-code").first).to_contain_text("different code: components/my_way.py.")
    visit.shot("first-hour-compare")


def catalogue(visit: Visit) -> dict[str, Any]:
    answer: dict[str, Any] = visit.page.request.get(f"{visit.address}/api/v1/components").json()
    return answer


def submitted(visit: Visit, number: int) -> str:
    """Start the campaign; the word of its verdict."""
    page, headers = visit.page, {"Origin": visit.address}
    given = page.request.post(f"{visit.address}/api/v1/runs", data={"campaign": campaign()}, headers=headers)
    assert given.status == 201, given.text()
    visit.move(f"/runs/R-{number:04d}")
    outcome = page.get_by_test_id("verdict")
    expect(outcome).to_have_text(re.compile("Cleared|Violated|Inconclusive"), timeout=90_000)
    return re.search("Cleared|Violated|Inconclusive", outcome.inner_text())[0]  # type: ignore[index]
