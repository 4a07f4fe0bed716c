"""The baseline stage: which findings of an earlier run it evaluates, where validation finds them again."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from backend.db import baselines, labels
from backend.db.engine import connect, read
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from campaigns import Campaign
from campaigns.asked.allowance import STARTS
from campaigns.asked.load import load_document
from campaigns.claims.stages.earlier_run import not_random, outside, unknown
from campaigns.refusals import RefusalCode
from campaigns.results.base import EXCLUDED
from campaigns.stages.baseline import BaselineResult
from campaigns.stages.plan import most
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from clearance.testing.problems import Problem
from clearance.testing.searching import batch
from tests.given.baseline_stage import PLAN, against, context, ran, since
from tests.given.case_campaigns import campaign, searching
from tests.given.corrupted_records import DIRECT, NOISE, SHORT, SQP, Folder
from tests.given.refused_commands import refused
from tests.migrated import migrated
from worker.engine.search.base import Floats
from worker.engine.stages import baseline
from worker.engine.stages.parts import candidates, findings, offered
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.falls import not_compared
from worker.engine.stages.parts.left import Left
from worker.evidence.audit import judge, limits, reevaluation
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute

CORNER = {"vehicle.m": 6.0, "vehicle.J": 0.06}


WELLS = ([0.23, 0.31], [0.77, 0.69])


def two_wells(points: Floats) -> Floats:
    """1 but for two wells, whose bottoms violate."""
    wells = sum(np.exp(-((points - place) ** 2).sum(axis=1) / 0.005) for place in WELLS)
    return np.asarray(1.0 - 0.7 * wells + 0.05 * ((points - 0.5) ** 2).sum(axis=1))


def flat(points: Floats) -> Floats:
    return 1.0 + points.sum(axis=1)


def test_a_finding_is_evaluated_at_its_own_bits() -> None:
    made = context(against({"parameters": CORNER}), flat)
    point = np.array([0.123456789012345, 1.0 / 3.0])
    exact = made.problem.named(point)
    made = context(against({"parameters": exact, "point": point.tolist()}, {"parameters": CORNER}), flat)
    result = ran(made)
    stored = made.store.evaluations(1)
    assert stored is not None
    assert stored.points.tolist() == [point.tolist(), [1.0, 1.0]]
    assert [case.parameters for case in result.cases] == [exact, CORNER]
    assert [case.cost for case in result.cases] == [1.0 + point.sum(), 3.0]
    assert result.text == "2 of 2 findings of R-0001 evaluated"


@pytest.mark.parametrize(
    ("parameters", "statement"),
    [
        ({"vehicle.m": 6.5}, "vehicle.m = 6.5 is outside the bounds 4 to 6 of this campaign"),
        ({"vehicle.wheels": 4.0}, "there is no parameter vehicle.wheels"),
        ({"avoider.d_0": 1.0}, "avoider.d_0 = 1 is no longer uncertain: it is 2"),
        ({"vehicle.m": 3.0, "vehicle.q": 1.0}, "vehicle.m = 3 is outside the bounds 4 to 6 of this campaign; there is"),
    ],
)
def test_parameters_that_cannot_be_had_are_named(parameters: dict[str, float], statement: str) -> None:
    made = context(against({"parameters": parameters}, {"parameters": CORNER}), flat)
    result = ran(made)
    lost, found = result.cases
    assert (lost.index, lost.cost, lost.parameters) == (None, None, parameters)
    assert statement in lost.reason
    assert (found.index, found.cost) == (0, 3.0)
    assert f"1 of 2 findings of R-0001 evaluated; F1 was not evaluated: {statement}" in result.text


def fixed(made: Campaign, **values: float) -> Campaign:
    """The campaign with a baseline that states the values that it did not vary."""
    return load_document({**made.document(), "baseline": {**made.document()["baseline"], "fixed": values}})


def test_a_parameter_that_is_fixed_at_its_value_and_one_that_the_baseline_fixed() -> None:
    """It is evaluated at the value that it had there, not at the nominal one."""
    asked = against({"parameters": {"vehicle.m": 6.0, "avoider.d_0": 2.0}})
    result = ran(context(fixed(asked, **{"vehicle.J": 0.04, "vehicle.m": 1.0}), flat))
    assert result.cases[0].parameters == {"vehicle.m": 6.0, "vehicle.J": 0.04}
    assert result.cases[0].assumed == ["vehicle.J"]
    assert "; vehicle.J of F1 " in result.text


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({}, unknown("vehicle.J", "R-0001")),
        ({"vehicle.J": 0.9}, outside("vehicle.J", 0.9, 0.04, 0.06)),
    ],
)
def test_a_case_is_compared_only_at_all_its_values(values: dict[str, float], why: str) -> None:
    """A baseline of an earlier version does not state them."""
    asked = against({"parameters": {"vehicle.m": 6.0}})
    for made in (fixed(asked, **values), *([] if values else [asked])):
        (case,) = ran(context(made, flat)).cases
        assert (case.index, case.cost) == (None, None)
        assert case.reason == why


@pytest.mark.parametrize("beyond", [1e-11, 1e-3])
def test_a_bound_that_was_computed_in_another_way_is_within(beyond: float) -> None:
    """Of a value that the baseline varied and of one that it fixed: each is evaluated at the bound. The audit has the
    same rule."""
    high = {"vehicle.m": 6.0 * (1.0 + beyond), "vehicle.J": 0.06 * (1.0 + beyond)}
    varied = fixed(against({"parameters": high}))
    for asked in (varied, fixed(against({"parameters": {"vehicle.m": 6.0}}), **{"vehicle.J": high["vehicle.J"]})):
        made = context(asked, flat)
        (case,) = ran(made).cases
        assert (case.parameters == CORNER) is (case.index is not None) is (beyond < 1e-9)
        bounds = {"vehicle.m": (4.0, 6.0), "vehicle.J": (0.04, 0.06)}
        run: Any = SimpleNamespace(
            campaign=asked, bounds=bounds, known=dict.fromkeys(bounds, ("", 5.0)), fixed_seeds=[], random=[],
            wording=limits.EACH,
        )  # fmt: skip
        assert asked.baseline is not None
        assert reevaluation._possible(run, asked.baseline.cases[0]) is (case.index is not None)


def test_a_baseline_of_which_nothing_can_be_evaluated_says_so() -> None:
    made = context(against({"parameters": {"vehicle.m": 9.0}}), flat)
    assert ran(made).text.startswith("0 of 1 finding of R-0001 evaluated; F1 was not evaluated: ")
    assert made.store.evaluations(1) is None


def test_another_threshold_is_stated() -> None:
    made = context(against({"parameters": CORNER}, criterion__threshold=0.6), flat)
    thresholds = ran(made).text.rpartition("; ")[2]
    assert [thresholds.count(value) for value in ("R-0001", "0.5 m", "0.6 m")] == [1, 1, 1]


def test_a_case_without_a_value_has_its_reason() -> None:
    made = context(against({"parameters": CORNER}), flat)
    made.evaluate = lambda points, seeds=None: (batch(np.full(len(points), np.nan), EXCLUDED), {0: "starts inside"})
    (case,) = ran(made).cases
    assert (case.status, case.cost, case.reason) == ("excluded", None, "starts inside")


def test_a_resumed_stage_evaluates_nothing_again() -> None:
    made = context(against({"parameters": CORNER}, {"parameters": {"vehicle.m": 4.0}}), flat)
    first = ran(made)

    def never(points: Floats, seeds: Any = None) -> Any:
        raise AssertionError("evaluated again")

    again = Context(made.campaign, made.problem, never, made.store, plan=PLAN)
    assert baseline.run(again, 1).result == first


def test_every_case_is_followed_to_its_basin() -> None:
    problem = Problem(campaign())
    near = [problem.named(np.array(w) + 0.02) for w in (*WELLS, WELLS[0])]
    made = context(against(*({"parameters": parameters} for parameters in near)), two_wells)
    ran(made)
    found = findings.Found()
    drive(made, 2, findings.search(made, 2, found), 10**5, repeats=True)
    assert not findings.settle(made, 2, found, Left(made.campaign, False, 0))
    labels = [f"F{i}" for i in range(1, len(found.basins) + 1)]
    where = {label: basin.point for label, basin in zip(labels, found.basins, strict=True)}
    first, second, third = since(made, found, labels)
    assert first is not None
    assert second is not None
    assert np.allclose(where[first], WELLS[0], atol=0.01)
    assert np.allclose(where[second], WELLS[1], atol=0.01)
    assert third == first


@pytest.mark.by_day(1)
@pytest.mark.parametrize("most", [8, 24])
def test_cases_are_followed_however_many_findings_are_listed(most: int) -> None:
    turned, k = np.array([[0.8, 0.6], [-0.6, 0.8]]), np.arange(12)

    def rugged(points: Floats) -> Floats:
        along = ((points - 0.3) @ turned)[..., None]
        dips = (0.5**k * (1.0 - np.cos(2.0 * np.pi * 3.0**k * along))).sum(axis=(-1, -2))
        waves = 0.2 * np.cos(25.0 * points).sum(axis=-1) + 0.3 * ((points - 0.4) ** 2).sum(axis=-1)
        return np.asarray(0.45 + 0.02 * dips + waves)

    problem = Problem(campaign())
    cases = [{"parameters": problem.named(p), "cost": 0.3} for p in np.random.default_rng(5).random((12, 2))]
    stages = {"stages__findings": {"at_most": most}, "stages__validate": {"evaluations": 40_000, "neighbours": 20}}
    made = context(against(*cases, **stages), rugged)
    ran(made)
    found = findings.Found()
    allowed = findings.validation(made.campaign).stored
    driven = drive(made, 2, findings.search(made, 2, found), allowed, repeats=True)
    assert not findings.settle(made, 2, found, Left(made.campaign, False, driven.tally.evaluations))
    labels = [f"F{i}" for i in range(1, len(found.basins) + 1)]
    assert None not in since(made, found, labels)
    assert not any(not_compared(made, 2, found.falls, index) for index in range(len(cases)))


def test_more_cases_than_candidates_are_all_followed() -> None:
    problem = Problem(campaign())
    many = [
        {"parameters": problem.named(np.array([x, y]))} for x in np.linspace(0, 1, 10) for y in np.linspace(0, 1, 9)
    ]
    made = context(against(*many), two_wells)
    ran(made)
    gathered, _ = candidates.gather(made, 2)
    assert len(gathered) == len(many) > STARTS


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer simulations with the reference integrator, in the run and in its audit."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    monkeypatch.setattr(offered, "AT_MOST", 3)
    monkeypatch.setattr(judge.audit, "__defaults__", (offered.AT_MOST, offered.SPOT_CHECKS))


def write(path: Path, **changes: Any) -> Path:
    path.write_text(json.dumps(searching(DIRECT, SQP, **SHORT, **changes).document()))
    return path


@pytest.mark.nightly  # by day a stored run is compared, audited and extended, below; test_known_regions.py fails by one
def test_a_worse_controller_fails_and_every_other_command_reads_the_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    good, bad = write(tmp_path / "good.json"), tmp_path / "bad.json"
    first, second, more = (str(tmp_path / name) for name in ("first", "second", "more"))
    assert invoke(["run", str(good), "--out", first]) == 0
    document = json.loads(good.read_text()) | {"regression": {"fail_on": ["worse"], "tolerance": 0.001}}
    good.write_text(json.dumps(document))
    assert invoke(["run", str(good), "--baseline", first, "--junit", str(tmp_path / "a" / "j.xml")]) == 0
    assert f" {first}: 1 same." in capsys.readouterr().out
    document["scenario"]["avoider"]["parameters"]["d_0"] = 1.6
    bad.write_text(json.dumps(document))
    options = ["--label", "branch=slow", "--baseline", first, "--summary", str(tmp_path / "s.md")]
    assert invoke(["run", str(bad), "--out", second, *options]) == 1
    statement = capsys.readouterr().out
    result = json.loads((tmp_path / "second" / "result.json").read_text())
    assert result["regression"]["text"] in statement
    assert result["labels"] == {"branch": "slow"}
    assert [(case["standing"], case["fails"]) for case in result["regression"]["cases"]] == [("worse", True)]
    assert f"| F1 of {first} | **worse** |" in (tmp_path / "s.md").read_text().replace("\\", "")
    for command in (["audit", second], ["replay", second, "baseline:0"]):
        assert invoke(command) == 0, (command, capsys.readouterr().out)
    assert_audit_notices(Folder(tmp_path / "second"), capsys)
    assert invoke(["run", "--continue", second, "--budget", "+20", "--out", more]) == 1
    assert json.loads((tmp_path / "more" / "result.json").read_text())["regression"]["run"] == first


def stored(engine: sa.Engine, launched: Campaign, request: str, **labels: str) -> int:
    """A run in a database, launched with these labels and carried out."""
    with engine.begin() as writer:
        found = (
            baselines.resolved(writer, launched, request, catalogue())
            if request
            else baselines.Resolved(launched, None, "")
        )
        run_id = submit(
            writer,
            found.campaign,
            name="a",
            tags=[],
            owner="",
            planned=most(found.campaign),
            catalogue=catalogue(),
            labelled=labels,
        )
        if request:
            baselines.store(writer, run_id, request, found.run_id)
    claim = Queue(engine).claim("w")
    assert claim is not None
    execute(load_document(claim.document), RunStore(engine, claim), threads=1)
    return run_id


@pytest.mark.nightly
def test_a_stored_run_is_compared_audited_and_extended(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    engine = connect(migrated(tmp_path))
    policy = {"fail_on": ["worse"], "tolerance": 0.001}
    launched = searching(DIRECT, SQP, **SHORT, regression=policy)
    assert stored(engine, launched, "", branch="main") == 1
    slow = searching(DIRECT, SQP, **SHORT, regression=policy, scenario__avoider__parameters__k_rep=3.0)
    assert stored(engine, slow, "label:branch=main", branch="slow") == 2
    data = ["--data", str(tmp_path)]
    assert invoke(["audit", "R-0002", *data]) == 0
    assert invoke(["replay", "R-0002", "baseline:0", *data]) == 0
    with read(engine) as reader:
        stated = baselines.resolved(reader, launched, "label:branch=main", catalogue()).sentence
    capsys.readouterr()
    assert invoke(["run", "--continue", "R-0002", "--budget", "+20", "--threads", "1", *data]) == VIOLATED
    assert "R-0003 extends R-0002" in capsys.readouterr().out
    file = tmp_path / "good.json"
    file.write_text(json.dumps(launched.document()))
    assert invoke(["run", str(file), "--threads", "1", "--baseline", "label:branch=main", *data]) == 0
    assert f"{stated}\n" in capsys.readouterr().out
    with read(engine) as reader:
        assert baselines.of_run(reader, 3) == ("label:branch=main", 1)
        assert labels.of_runs(reader, [1, 2, 3]) == {
            1: {"branch": "main"}, 2: {"branch": "slow"}, 3: {"branch": "slow"},
        }  # fmt: skip
    engine.dispose()


CASE = "result/regression/cases/0"
CORRUPTIONS: list[tuple[str, Any, str]] = [
    (f"{CASE}/standing", "same", "regression.cases.0.standing"),
    (f"{CASE}/margin_before", 0.43, "regression.cases.0.margin_before"),
    (f"{CASE}/margin_again", 0.44, "regression.cases.0.margin_again"),
    (f"{CASE}/margin", 0.44, "regression.cases.0.margin"),
    (f"{CASE}/change", 0.0, "regression.cases.0.change"),
    (f"{CASE}/tolerance", 1.0, "regression.cases.0.tolerance"),
    (f"{CASE}/fails", False, "regression.cases.0.fails"),
    ("result/regression/ok", True, "regression.ok"),
    ("result/regression/accepted", True, "regression.accepted"),
    ("result/regression/run", "R-0009", "regression.run"),
    ("result/regression/cases", [], "regression.cases.count"),
    ("evidence/results/1/cases/0/cost", 0.5, "results.1.cases.0.cost"),
    ("campaign/regression/fail_on", ["new"], "regression.cases.0.fails"),
]


def assert_audit_notices(folder: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    """Every number and word of the comparison is recomputed."""
    kept = json.dumps([folder.result, folder.evidence, folder.campaign])
    for place, value, item in CORRUPTIONS:
        folder.result, folder.evidence, folder.campaign = json.loads(kept)
        folder.set(place, value)
        assert item in {i.name for i in folder.items() if i.agrees is False}, place
    folder.result, folder.evidence, folder.campaign = json.loads(kept)
    del folder.result["regression"]
    folder.write()
    capsys.readouterr()
    assert invoke(["audit", str(folder.path), "--json"]) == VIOLATED
    items = {item["name"]: item["agrees"] for item in json.loads(capsys.readouterr().out)["items"]}
    assert (items["verdict"], items["whole"]) == (None, False), "of this version it is forged"
    folder.forget_seal()
    folder.write()
    assert invoke(["audit", str(folder.path), "--json"]) == VIOLATED
    items = {item["name"]: item["agrees"] for item in json.loads(capsys.readouterr().out)["items"]}
    assert (items["verdict"], False in items.values()) == (None, False), "it is not known whether it follows"
    folder.result, folder.evidence, folder.campaign = json.loads(kept)
    folder.write()


@pytest.mark.parametrize(
    ("arguments", "statement"),
    [
        (["--baseline", "R-0001"], "there is no database at"),
        (["--baseline", "missing"], "there is no database at"),
        (["--label", "branch"], "invalid label 'branch'"),
        (["--junit", "/proc/none/j.xml"], "/proc/none/j.xml cannot be written"),
    ],
)
def test_a_bad_option_is_refused_before_anything_is_simulated(
    arguments: list[str], statement: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write(tmp_path / "campaign.json")
    assert invoke(["run", str(file), "--data", str(tmp_path), *arguments]) == WRONG_INPUT
    assert statement in capsys.readouterr().err


def test_an_extended_run_takes_no_other_baseline(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "run", "--continue", "x", "--budget", "+1", "--baseline", "R-0001") == RefusalCode.OPTIONS


@pytest.mark.nightly
def test_drawn_noise_is_simulated_with_the_seed_of_the_baseline(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The seed is part of the case: it is stored with it, evaluated first, and replayed."""
    file = write(tmp_path / "noisy.json", **NOISE)
    document = json.loads(file.read_text())
    cases = [
        {"label": "F1", "parameters": CORNER, "cost": 0.9},
        {"label": "F2", "parameters": CORNER, "cost": 0.9, "realisation": 7},
        {"label": "F3", "parameters": CORNER, "cost": 0.9, "realisation": 8},
    ]
    document["baseline"] = {"run": "R-0001", "digest": "0" * 64, "threshold": 0.5, "cases": cases}
    file.write_text(json.dumps(document))
    out = str(tmp_path / "out")
    invoke(["run", str(file), "--out", out])
    evidence = json.loads((tmp_path / "out" / "evidence.json").read_text())
    result = BaselineResult.model_validate(evidence["results"][1])
    assert [(c.label, c.index, c.realisation) for c in result.cases] == [("F1", 2, None), ("F2", 0, 7), ("F3", 1, 8)]
    assert result.seeds == [7, 8]
    assert len({c.cost for c in result.cases}) == 3
    capsys.readouterr()
    assert invoke(["replay", out, "baseline:0", "baseline:1", "baseline:2"]) == 0
    assert invoke(["audit", out]) == 0


def test_a_seed_without_noise_is_named() -> None:
    made = context(against({"parameters": CORNER, "realisation": 7}), flat)
    assert ran(made).cases[0].reason == not_random(7)
