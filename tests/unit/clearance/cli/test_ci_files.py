"""What a CI job gets of a run: cases of JUnit for criterion and checks, SARIF with lines of the campaign, a picture."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from xml.etree import ElementTree as Xml

import pytest

from campaigns.refusals import RefusalCode
from campaigns.results import Verdict
from campaigns.results.verdict import Check
from campaigns.rules import RULES
from clearance.cli import INTERNAL, WRONG_INPUT, invoke
from clearance.cli._ended import OUTCOMES, Case, EndedRun, Source
from clearance.cli._junit import junit
from clearance.cli._markdown import markdown
from clearance.cli._sarif import lines, sarif, write
from tests import results
from tests.given.refused_commands import refused

TEXT = """\
# Reviewed.
name: Case
uncertain:
  vehicle.m: {low: 4, high: 6}
  "vehicle.J":
    low: 0.04
criterion:
  threshold: 0.5
stages:
  search: []
"""
PARAMETERS = {"vehicle.m": 6.0, "vehicle.J": 0.1 + 0.2}
WORST = Case("F1", 0.3, -0.2, PARAMETERS)
FINE = Case("F2", 0.9, 0.4, PARAMETERS)
TITLES = {rule.code: rule.title for rule in RULES}


def verdict(word: str, *failing: str) -> Verdict:
    checks = [Check(code="nominal", ok=True, statement=results.statement("margin +0.9 m"))]
    checks += [Check(code=code, ok=False, statement=results.statement(f"{code} <fails>")) for code in failing]
    return results.verdict(word, f"It is {word}.", 1.4, 0.3 if word == "violated" else 1.3, checks=checks)


def ended(word: str = "violated", *failing: str, **changes: Any) -> EndedRun:
    known: dict[str, Any] = {"run": "R-0007", "campaign": "Case <1>", "state": "done", "link": "http://x/runs/R-0007"}
    known |= {"verdict": verdict(word, *failing) if word else None, "replay": "clearance replay R-0007"}
    known |= {"quantity": "d_min", "unit": "m", "threshold": 0.5, "findings": (WORST, FINE)}
    return EndedRun(**(known | {"source": Source("campaign.yaml", TEXT)} | changes))


def cases(given: EndedRun) -> dict[str, Xml.Element]:
    found = {str(case.get("name")): case for case in Xml.fromstring(junit(given)).iter("testcase")}
    return {name: case for name, case in found.items() if ":" in name}


def outcome(case: Xml.Element) -> str:
    return {"system-out": "passed"}.get(case[0].tag, case[0].tag)


def test_the_criterion_fails_with_parameters_link_and_replay_command() -> None:
    case = cases(ended())["criterion: d_min"]
    assert str(case[0].text).splitlines() == [
        "F1: 0.3 m, margin \u22120.2 m",
        "vehicle.m = 6.0",
        "vehicle.J = 0.30000000000000004",
        "clearance replay R-0007 F1",
        "http://x/runs/R-0007",
    ]
    assert (case[0].tag, case[0].get("message")) == ("failure", "F1 violates the criterion")


NOWHERE = ["--service", "http://127.0.0.1:9", "--patience", "0"]


@pytest.mark.parametrize(
    "words",
    [
        ["run"],
        ["run", "no_such_campaign"],
        ["run", "unicycle_static", "--threads", "many"],
        ["run", "unicycle_static", "--label", "none"],
        ["run", "unicycle_static", "--no-such-option"],
        ["submit", "unicycle_static", "--no-such-option", "7"],
        ["follow", "R-0001", "-x"],
        ["run", "--continue", "no_such_folder", "--budget", "+10"],
        ["submit"],
        ["submit", "unicycle_static", "--no-wait"],
        ["submit", "unicycle_static", *NOWHERE],
        ["follow", "R-0001", *NOWHERE],
        ["follow", "first"],
    ],
    ids=" ".join,
)
def test_no_file_of_an_earlier_build_survives_an_end_without_a_verdict(words: list[str], tmp_path: Path) -> None:
    cases, found = tmp_path / "j.xml", tmp_path / "s.sarif"
    cases.write_text(junit(ended("cleared")), encoding="utf-8")
    found.write_text(json.dumps(sarif(ended("cleared"))), encoding="utf-8")
    assert invoke([*words, "--junit", str(cases), "--sarif", str(found)]) in (WRONG_INPUT, INTERNAL)
    suite = Xml.parse(cases).getroot()[0]
    assert [suite.get(kind) for kind in ("tests", "errors", "failures", "skipped")] == ["1", "1", "0", "0"]
    assert suite.find(".//property[@name='outcome']") is None, "how it ends is not known"
    [run] = json.loads(found.read_text(encoding="utf-8"))["runs"]
    assert [(result["ruleId"], result["level"]) for result in run["results"]] == [("no-verdict", "error")]
    assert (run["invocations"][0]["executionSuccessful"], "exitCode" in run["invocations"][0]) == (False, False)


COMMANDS = (["run", "unicycle_static"], ["submit", "unicycle_static", *NOWHERE], ["follow", "R-0001", *NOWHERE])
OPTIONS = ("--junit", "--summary", "--sarif")


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
@pytest.mark.parametrize("pair", [*itertools.permutations(OPTIONS, 2)], ids=" ".join)
def test_two_options_with_one_file_are_refused(
    command: list[str], pair: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """However its path is written."""
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    files = (pair[0], "a.xml", pair[1], "folder/../a.xml")
    assert refused(capsys, *command, *files) == RefusalCode.OPTIONS


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
@pytest.mark.parametrize("option", OPTIONS)
def test_a_file_of_the_job_that_would_be_replaced_by_one_of_the_folder_is_refused(
    command: list[str], option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    local = command[0] == "run"
    names = ("result.json", "trace-F7.csv", "campaign.json") if local else ("report.html", "run.json", "worst-case.svg")
    for number, name in enumerate(names):
        files = ("--out", f"out{number}", option, f"./out{number}/{name}")
        assert refused(capsys, *command, *files) == RefusalCode.OPTIONS


def test_a_device_may_be_named_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEARANCE_TOKEN", "t")
    assert invoke(["follow", "R-0001", *NOWHERE, "--junit", "/dev/null", "--sarif", "/dev/null"]) == INTERNAL


@pytest.mark.parametrize(
    "words",
    [
        ["--junit=j.xml", "--no-such-option"],
        ["--no-such-option", "--junit", "j.xml"],
        ["--junit", "j.xml", "--budget"],  # which has no value
    ],
    ids=" ".join,
)
def test_a_usage_error_writes_the_file_wherever_it_is_named(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke(["run", "unicycle_static", *words]) == WRONG_INPUT
    assert Xml.parse(tmp_path / "j.xml").getroot()[0].get("errors") == "1"


@pytest.mark.parametrize(
    "words",
    [
        ["runs", "--junit", "j.xml"],  # which has no such option
        ["run", "unicycle_static", "--no-such-option", "--junit"],
        ["run", "unicycle_static", "--no-such-option", "--junit", "--sarif"],
        ["run", "unicycle_static", "--no-such-option", "--", "--junit", "j.xml"],
    ],
    ids=" ".join,
)
def test_a_usage_error_writes_no_file_that_is_not_of_a_job(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke(words) == WRONG_INPUT
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("option", ["--junit", "--sarif"])
def test_a_file_with_other_content_is_not_replaced(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "campaign.yaml").write_text(TEXT, encoding="utf-8")
    assert invoke(["run", option, str(tmp_path / "campaign.yaml")]) == WRONG_INPUT
    assert f"{option} {tmp_path}" in capsys.readouterr().err
    assert invoke(["run", option, str(tmp_path / "campaign.yaml"), "--no-such-option"]) == WRONG_INPUT
    assert (tmp_path / "campaign.yaml").read_text(encoding="utf-8") == TEXT


@pytest.mark.parametrize(
    ("word", "findings", "told"),
    [
        ("cleared", (FINE,), "passed"),
        ("inconclusive", (FINE,), "skipped"),
        ("inconclusive", (WORST,), "failure"),
        ("violated", (), "failure"),
    ],
)
def test_the_criterion_passes_only_if_it_is_cleared(word: str, findings: tuple[Case, ...], told: str) -> None:
    assert outcome(cases(ended(word, findings=findings))["criterion: d_min"]) == told


def test_a_value_is_read_on_its_own_side_of_the_threshold_in_every_file() -> None:
    limit = 1699999999.95
    close = ended(threshold=limit, findings=(Case("F1", limit - 0.01, -0.01, PARAMETERS),))
    assert str(cases(close)["criterion: d_min"][0].text).startswith("F1: 1699999999.9 m")
    texts = [result["message"]["text"] for result in sarif(close)["runs"][0]["results"]]
    (found,) = (text for text in texts if text.startswith("F1"))
    assert {"1699999999.9", "1699999999.95"} <= set(found.split())


def test_what_is_not_confirmed_is_no_violation_in_any_file() -> None:
    """F1 is lower in the search, and above the threshold when evaluated again; F2 violates both times."""
    doubtful = ended(
        findings=(replace(WORST, confirmed=False), replace(WORST, label="F2", cost=0.4, margin=-0.1), FINE)
    )
    (failure,) = cases(doubtful)["criterion: d_min"]
    stated = str(failure.get("message")).partition("; ")
    assert (stated[0].partition(" ")[0], stated[2].partition(" ")[0]) == ("F2", "F1")
    assert [line.endswith("not confirmed") for line in str(failure.text).splitlines() if "margin" in line] == [
        True,
        False,
    ]
    levels = {r["message"]["text"].partition(":")[0]: r["level"] for r in logged(doubtful)["results"]}
    assert levels == {"F1": "warning", "F2": "error"}
    (failure,) = cases(ended("inconclusive", findings=(replace(WORST, confirmed=False),)))["criterion: d_min"]
    assert failure.get("type") == "unconfirmed"


def test_the_noise_of_a_case_is_named_in_every_file() -> None:
    drawn = ended(findings=(replace(WORST, seed=14115), FINE))
    for text in (junit(drawn), json.dumps(sarif(drawn))):
        assert text.count("14115") == 1
    assert not any("noise seed" in text for text in (junit(ended()), json.dumps(sarif(ended()))))


@pytest.mark.parametrize("word", ["violated", "inconclusive", ""])
def test_whatever_fails_has_the_link_of_the_run(word: str) -> None:
    suite = Xml.fromstring(junit(ended(word, "agreement", requirements=("R1", "R2"))))
    failing = [*suite.iter("failure"), *suite.iter("error")]
    assert len(failing) >= 3
    for one in failing:
        assert "http://x/runs/R-0007" in str(one.text).splitlines()


def test_every_check_is_a_case() -> None:
    found = cases(ended("inconclusive", "agreement", "mine"))
    assert {name: outcome(case) for name, case in found.items() if name.startswith("check")} == {
        f"check: {TITLES['nominal']}": "passed",
        f"check: {TITLES['agreement']}": "failure",
        "check: Mine": "failure",
    }
    assert found["check: Mine"][0].get("message") == "mine <fails>"


def test_a_run_without_a_verdict_has_no_criterion_and_no_check() -> None:
    assert cases(ended("", state="failed", error="lost")) == {}


def logged(given: EndedRun) -> dict[str, Any]:
    log = sarif(given)
    assert problems(log) == []
    return dict(log["runs"][0])


URI = ("uri", "hostedViewerUri", "$schema")


def problems(log: dict[str, Any]) -> list[str]:
    """What breaks the rules of SARIF 2.1.0 that consumers rest on (sections 3.13, 3.14, 3.27, 3.28, 3.30, 3.52)."""
    found = [] if log["version"] == "2.1.0" else ["version"]
    for run in log["runs"]:
        rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
        found += [] if len(rules) == len(set(rules)) else ["rules"]
        for result in run["results"]:
            found += [] if rules[result["ruleIndex"]] == result["ruleId"] else ["ruleIndex"]
            found += [] if result["level"] in ("none", "note", "warning", "error") else ["level"]
            found += [] if result["message"]["text"] else ["message"]
            states = ("new", "unchanged", "updated", "absent")
            found += [] if result.get("baselineState", "new") in states else ["baselineState"]
            ids = [place["id"] for place in result.get("relatedLocations", ())]
            found += [] if len(ids) == len(set(ids)) else ["relatedLocations"]
    for key, value in flat(log):
        if key in URI and (" " in value or not (urlsplit(value).scheme or key == "uri")):
            found.append(f"{key}: {value}")
        if key in ("startLine", "startColumn") and value < 1:
            found.append(key)
        if value is None:
            found.append(f"{key} is null")
    return found


def flat(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Every value that is no object or array, with its key."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from flat(inner, name)
    elif isinstance(value, list):
        for inner in value:
            yield from flat(inner, key)
    else:
        yield key, value


def test_a_violation_points_at_the_criterion_and_at_the_ranges() -> None:
    run = logged(ended())
    (result,) = run["results"]
    assert (result["ruleId"], result["level"]) == ("violation", "error")
    (place,) = result["locations"]
    assert place["physicalLocation"] == {
        "artifactLocation": {"uri": "campaign.yaml", "uriBaseId": "%SRCROOT%"},
        "region": {"startLine": 7, "startColumn": 1},
    }
    ranges = [(p["physicalLocation"]["region"]["startLine"], p["message"]["text"]) for p in result["relatedLocations"]]
    assert ranges == [(4, "vehicle.m = 6.0"), (5, "vehicle.J = 0.30000000000000004")]
    assert result["properties"] == {"cost": 0.3, "margin": -0.2, "parameters": PARAMETERS}
    assert "clearance replay R-0007 F1" in result["message"]["text"]
    assert run["invocations"] == [{"executionSuccessful": True, "exitCode": 1}]


def test_failed_checks_are_results_and_what_is_not_confirmed_is_no_error() -> None:
    run = logged(ended("inconclusive", "agreement", "closest approach"))
    assert [(r["ruleId"], r["level"]) for r in run["results"]] == [
        ("violation", "warning"),
        ("check/agreement", "warning"),
        ("check/closest-approach", "warning"),
    ]
    assert "It is inconclusive." in run["results"][0]["message"]["text"]
    assert run["results"][1]["locations"][0]["physicalLocation"]["region"]["startLine"] == 10
    assert [rule["shortDescription"]["text"] for rule in run["tool"]["driver"]["rules"]][1:] == [
        f"Check: {TITLES['agreement']}",
        f"Check: {TITLES['closest approach']}",
    ]


def test_a_cleared_run_has_no_result_and_a_lost_one_has() -> None:
    assert logged(ended("cleared", findings=(FINE,)))["results"] == []
    run = logged(ended("", state="failed", error="its worker was lost"))
    assert [r["ruleId"] for r in run["results"]] == ["no-verdict"], "nothing was fixed"
    assert run["invocations"][0]["executionSuccessful"] is False


def test_a_finding_has_the_same_fingerprint_in_the_next_run() -> None:
    first, again = logged(ended()), logged(ended(run="R-0008", findings=(Case("F1", 0.2, -0.3, {}),)))
    marks = {json.dumps(run["results"][0]["partialFingerprints"]) for run in (first, again)}
    assert len(marks) == 1
    assert json.dumps(logged(ended(campaign="Other"))["results"][0]["partialFingerprints"]) not in marks


@pytest.mark.parametrize("address", ["/elsewhere/a b.yaml", "http://x/api/v1/runs/R-0007/campaign.yaml"])
def test_a_campaign_in_another_place_is_named_by_its_address(address: str) -> None:
    (result,) = logged(ended(source=Source(address, TEXT)))["results"]
    uri = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert uri in ("file:///elsewhere/a%20b.yaml", address)


def test_it_is_written_as_text_of_any_language(tmp_path: Path) -> None:
    write(tmp_path / "x.sarif", ended(campaign="Fall \u2603"))
    assert problems(json.loads((tmp_path / "x.sarif").read_text(encoding="utf-8"))) == []


@pytest.mark.by_day(2)
@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('{"criterion": {"threshold": 1},\n "seed": 2}', {"criterion": 1, "criterion.threshold": 1, "seed": 2}),
        ("a: &x {b: 1}\nc: *x\n", {"a": 1, "a.b": 1, "c": 2, "c.b": 1}),
        ("a: [unclosed", {}),
        ("", {}),
        ("[" * 20_000, {}),
    ],
)
def test_lines_of_any_text(text: str, found: dict[str, int]) -> None:
    assert {path: line for path, (line, _) in lines(text).items()} == found


def test_a_text_that_refers_to_itself_has_lines() -> None:
    assert lines("a: &x\n  b: *x\n")["a.b"] == (2, 3)


def test_the_summary_shows_the_picture_next_to_it() -> None:
    assert "](a%20b-R-0007.svg)" in markdown(ended(picture="a b-R-0007.svg"))
    assert "![" not in markdown(ended())


@pytest.mark.parametrize(
    ("word", "state", "code", "sign"),
    [
        ("cleared", "done", 0, "✅"),
        ("violated", "done", 1, "❌"),
        ("inconclusive", "done", 2, "❔"),
        ("", "failed", 4, "⚠️"),
        ("", "cancelled", 130, "⚠️"),
    ],
)
def test_the_summary_and_junit_open_with_the_meaning_of_the_exit_code(
    word: str, state: str, code: int, sign: str
) -> None:
    given = ended(word, state=state)
    # The verdict has no sample, which alone is missing to what is called cleared.
    outcome = f"exit code {code}: {OUTCOMES[code]}{': not sampled' * (word == 'cleared')}"
    assert markdown(given).splitlines()[0] == f"## {sign} Case \\<1\\>: {outcome}"
    stated = {p.get("name"): p.get("value") for p in Xml.fromstring(junit(given)).iter("property")}
    assert stated["outcome"] == outcome
