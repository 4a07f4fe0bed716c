"""Stored runs, and changes of their records that the audit must notice. Start reading at `CORRUPTIONS`."""

from __future__ import annotations

import fcntl
import hashlib
import json
import pickle
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

import numpy as np
import pytest
import sqlalchemy as sa

from backend.db import baselines
from backend.db.engine import connect
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.checked import turning
from campaigns.claims.spans import words
from campaigns.documents import digest_of
from campaigns.results.base import FAILED, OK
from campaigns.stages.plan import most
from campaigns.stored.digest import Rows, evidence_digest
from clearance.local.results import write_results
from clearance.local.summary import summary
from tests.given.case_campaigns import CASE1, searching
from tests.given.sampled_stages import DRAWN
from tests.migrated import migrated
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.engine.attraction import region
from worker.engine.stages.parts import encounter, offered
from worker.evidence.audit.judge import Item
from worker.evidence.audit.record import of_folder
from worker.evidence.audit.sentences import SPANS
from worker.running.catalogue.installed import catalogue
from worker.running.runs import identity
from worker.running.runs.audited import audited
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

T = TypeVar("T")

DIRECT = {"method": "direct", "evaluations": 100}

SQP = {"method": "sqp", "evaluations": 100, "starts": [{"vehicle.m": 4.5, "vehicle.J": 0.05}]}

SAMPLE = {"method": "monte_carlo", "evaluations": 60}

SHORT = {"scenario__horizon": 4.0}

NORMAL = {
    "vehicle.m": {"plus_minus": "20%", "distribution": {"kind": "normal", "mean": 5.0, "deviation": 0.4}},
    "vehicle.J": {"low": 0.04, "high": 0.06, "distribution": {"kind": "normal", "mean": 0.05, "deviation": 0.004}},
}

PAIR = [{"between": ["vehicle.m", "vehicle.J"], "value": 0.5}]

NOISE = {
    "scenario__faults": [{"component": "sensor_noise", "parameters": {"sigma": 0.01}}],
    "scenario__guidance": {"period": 0.1},
}
"""Of sampled guidance, so that it shares its compiled loop with other tests of noise."""

CERTIFY, GRID = 4, 9

"""The position of that stage, and how many points its grid has."""


def certifying(samples: int, *searches: dict[str, Any], **changes: Any) -> Campaign:
    document = searching(*(searches or (DIRECT, SQP)), **SHORT, **changes).document()
    document["stages"] |= {"certify": {"samples": samples, "grid": {"points": 3}}}
    return load_document(document)


def counting(samples: int, until: str = "samples", **changes: Any) -> Campaign:
    """With a sample of which only the lowest flights are stored."""
    document = searching(DIRECT, *(() if "uncertain" in changes else (SQP,)), **(SHORT | changes)).document()
    document["stages"] |= {"certify": {"samples": samples, "keep": "lowest", "until": until}}
    return load_document(document)


def estimating(**changes: Any) -> Campaign:
    """With an estimate of P(violation) over the violations that the search found."""
    document = searching(DIRECT, **(SHORT | {"criterion__threshold": 0.942} | changes)).document()
    document["stages"] |= {"certify": None, "estimate": {"evaluations": 1000}}
    return load_document(document)


def attracting(**changes: Any) -> Campaign:
    """With a region of attraction, of a loop whose slowest mode takes a second instead of minutes."""
    gains = {"scenario__controller__parameters__K_i2": 5.0}
    document = searching(DIRECT, **(SHORT | {"criterion__threshold": 0.942} | gains | changes)).document()
    document["stages"] |= {"certify": None, "attraction": {}}
    return load_document(document)


def since(threshold: float = 0.94175, there: float = 0.94175, costs: tuple[float, ...] = (0.9417, 0.93)) -> Campaign:
    """With a baseline: a case at the lowest corner, one that costs more here, one that this campaign cannot have."""
    at = [{"vehicle.m": 6.0, "vehicle.J": 0.06}, {"vehicle.m": 4.5, "vehicle.J": 0.05}, {"vehicle.m": 9.0}]
    cases = [
        {"label": f"F{k}", "parameters": parameters, "cost": cost}
        for k, (parameters, cost) in enumerate(zip(at, (*costs, 0.94), strict=True), 1)
    ]
    baseline = {"run": "R-0042", "digest": "0" * 64, "threshold": there, "cases": cases}
    asked = {"baseline": baseline, "criterion__threshold": threshold, "stages__certify": None}
    return searching(DIRECT, **(SHORT | asked))


def in_a_second(patch: pytest.MonkeyPatch) -> None:
    """A region of attraction of four states is smaller, and found in a second instead of ten."""
    patch.setattr(region, "PHASES", 1)
    patch.setattr(region, "ROUNDS", 2)


RUNS: dict[str, Callable[[], Campaign]] = {
    "cleared": lambda: certifying(150, uncertain=NORMAL, correlations=PAIR),
    "violated": lambda: searching(DIRECT, SQP, SAMPLE, criterion__threshold=0.94175, stages__certify=None, **SHORT),
    "estimated": lambda: estimating(),
    "attracted": lambda: attracting(),
    "inconclusive": lambda: searching(DIRECT, scenario__horizon=1.0),
    "since": since,
    "noisy": lambda: certifying(60, **NOISE),
    "alone": lambda: certifying(60, {"method": "auto", "evaluations": 300}),
    "counted": lambda: counting(1500),
    "counted noise": lambda: counting(1200, **NOISE),
    "counted correlations": lambda: counting(1100, uncertain=NORMAL, correlations=PAIR),
    "counted target": lambda: counting(3000, "target", target_probability=0.001, criterion__threshold=0.942),
    "counted violations": lambda: counting(3000, "target", target_probability=0.05, criterion__threshold=0.95),
    "counted exclusions": lambda: counting(
        1100,
        uncertain={"start.x": {"low": 3.0, "high": 5.0}, "start.y": {"low": 3.0, "high": 5.0}},
        scenario__start={"x": 3.0, "y": 3.0},
        scenario__horizon=1.0,
        criterion__threshold=0.6,
    ),
    "excluded": lambda: searching(
        {"method": "monte_carlo", "evaluations": 100, "options": {"interval": 0.5}},
        uncertain={"start.x": {"low": 3.0, "high": 5.0}, "start.y": {"low": 3.0, "high": 5.0}},
        scenario__start={"x": 3.0, "y": 3.0},
        scenario__horizon=1.0,
        criterion__threshold=0.6,
    ),
}

TURNING = {
    "component": "orbiting_circle",
    "parameters": {"centre": {"x": 40.0, "y": 40.0}, "way": 1.0, "phase": 0.0, "speed": 200.0, "radius": 0.1},
}
"""It turns by 1 rad in a step."""

FORGED: dict[str, Callable[[], Campaign]] = {
    "aliased": lambda: certifying(60, scenario__obstacles=[*CASE1["scenario"]["obstacles"], TURNING]),
}
"""As a service writes it that leaves out the check `sampling`."""

VERDICTS = {
    "estimated": "violated",
    "attracted": "inconclusive",
    "counted": "cleared",
    "counted correlations": "inconclusive",
    "counted noise": "cleared",
    "counted exclusions": "inconclusive",
    "counted target": "violated",
    "counted violations": "violated",
}
VERDICTS |= {
    "since": "violated",
    "noisy": "cleared",
    "alone": "cleared",
    "excluded": "inconclusive",
    "aliased": "cleared",
}


MADE = TemporaryDirectory(prefix="clearance-records-")
"""Made before the tests are divided among processes, which all have it."""


def once(made: Callable[[str], T]) -> Callable[[str], T]:
    """What is made of a name, once for all tests that confirm as many violations, make as many spot checks and simulate
    as many evaluations on: the first process that needs it stores it for the others."""

    @cache
    def known(name: str, *limits: int) -> T:
        file = Path(MADE.name, "_".join([made.__name__, name.replace(" ", "_"), *map(str, limits)]))
        with file.open("ab+") as stored:
            fcntl.flock(stored, fcntl.LOCK_EX)
            stored.seek(0)
            if content := stored.read():
                found: T = pickle.loads(content)
                return found
            value = made(name)
            stored.write(pickle.dumps(value))
        return value

    return lambda name: known(name, offered.AT_MOST, offered.SPOT_CHECKS, encounter.OTHERS)


@once
def ran(name: str) -> tuple[Campaign, MemoryStore]:
    campaign, store = (RUNS | FORGED)[name](), MemoryStore(sample_seed=DRAWN)
    with pytest.MonkeyPatch.context() as patch:
        in_a_second(patch)
        if name in FORGED:
            patch.setattr(turning, "unfollowed", lambda *_: ())
        conclusion = execute(campaign, store, threads=1)
    assert conclusion.verdict == VERDICTS.get(name, name), conclusion.reason
    return campaign, store


def written(folder: Path, name: str) -> Path:
    """The run as `clearance run --out` writes it."""
    folder.mkdir()
    return copied(files(name), folder)


@once
def files(name: str) -> dict[str, bytes]:
    """The files of the record, written once for all tests."""
    return made(*ran(name))


def made(campaign: Campaign, store: MemoryStore) -> dict[str, bytes]:
    """The files of a run by their names."""
    assert store.verdict is not None
    with TemporaryDirectory() as folder:
        write_results(Path(folder), campaign, store, summary(campaign, store, store.verdict))
        return {str(p.relative_to(folder)): p.read_bytes() for p in Path(folder).rglob("*") if p.is_file()}


def stored(folder: Path, name: str) -> sa.Engine:
    """A database with a run as written by a worker, with every stage in two chunks."""
    engine = connect(migrated(folder))
    enter(engine, *ran(name))
    return engine


def enter(engine: sa.Engine, campaign: Campaign, memory: MemoryStore, baseline: int | None = None) -> None:
    """Store a run as a worker does; baseline: the number of the run that it was launched with."""
    with engine.begin() as connection:
        submit(connection, campaign, name="a", tags=[], owner="", planned=most(campaign), seed=memory.sample_seed)
    claim = Queue(engine).claim("w")
    assert claim is not None
    store = RunStore(engine, claim)
    store.describe(campaign, catalogue())
    assert memory.verdict is not None
    store.record_versions(memory.verdict.provenance, identity.code(campaign))
    store.plan([record.plan for record in memory.stages])
    for position, record in enumerate(memory.stages):
        columns = memory.evaluations(position)
        assert columns is not None
        assert record.result is not None
        if memory.counted.get(position):
            store.count(position, memory.counted[position])
            store.keep(position, columns)
        half = len(columns.status) // 2
        for rows in () if memory.counted.get(position) else (slice(0, half), slice(half, None)):
            part = [getattr(columns, name)[rows] for name in ("points", "costs", "status", "seconds")]
            store.append(position, rows.start, columns._replace(**dict(zip(columns._fields, part, strict=False))))
        last = record.plan.kind == "validate"
        store.finish(position, record.result, 1.0, memory.findings if last else ())
    store.conclude(memory.verdict)
    with engine.begin() as connection:
        if baseline is not None:
            baselines.store(connection, claim.run_id, f"R-{baseline:04d}", baseline)


def copied(content: dict[str, bytes], folder: Path) -> Path:
    for name, data in content.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    return folder


class Folder:
    """The files of a run, to be changed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.result: Any
        self.evidence: Any
        self.campaign: Any
        self.result, self.evidence, self.campaign = (json.loads((path / name).read_text()) for name in self.FILES)
        with np.load(path / "evaluations.npz") as held:
            self.arrays: Any = {name: held[name].copy() for name in held.files}

    FILES = ("result.json", "evidence.json", "campaign.json")

    @property
    def worst(self) -> float:
        return float(self.result["worst"]["cost"])

    @property
    def best(self) -> Any:
        """The best of every search of a simulator that does not repeat."""
        return self.evidence["results"][-1]["incumbents"]

    def write(self) -> None:
        for name, value in zip(self.FILES, (self.result, self.evidence, self.campaign), strict=True):
            (self.path / name).write_text(json.dumps(value))
        np.savez(self.path / "evaluations.npz", **self.arrays)

    def items(self, write: bool = True) -> list[Item]:
        if write:
            self.write()
        return audited(of_folder(self.path))

    def shorten(self, stage: int, by: int = 1) -> None:
        for name in ("points", "costs", "status", "seconds"):
            self.arrays[f"{name}_{stage}"] = self.arrays[f"{name}_{stage}"][:-by]

    def set(self, path: str, to: Any) -> None:
        """Another value at a path such as result/findings/0/cost."""
        value, *above, last = path.split("/")
        held: Any = vars(self)[value]
        for key in above:
            held = held[int(key) if isinstance(held, list) else key]
        place: Any = int(last) if isinstance(held, list | np.ndarray) else last
        assert held[place] != to
        held[place] = to

    def reword(self, old: str, new: str) -> None:
        assert old in self.result["reason"]
        self.result["reason"] = self.result["reason"].replace(old, new)

    def lie(self, name: str, value: float) -> None:
        """Another number in the sentence, in its spans and in its words."""
        (span,) = [s for s in self.result["statement"] if s.get("name") == name]
        span["value"] = value
        self.render()

    def restate(self, old: str, new: str) -> None:
        """Other words in the sentence, in its spans and in what is written."""
        spans = [s for s in self.result["statement"] if old in (s.get("text") or s.get("label") or "")]
        assert spans
        for span in spans:
            key = "text" if span["kind"] == "text" else "label"
            span[key] = span[key].replace(old, new)
        self.render()

    def render(self) -> None:
        statement, scope = (SPANS.validate_python(self.result[name]) for name in ("statement", "holds_for"))
        self.result["reason"] = f"{words(statement)} Scope: {words(scope)}"

    def reseal(self) -> None:
        """Compute every digest again, as whoever knows how a record is written can."""
        self.result["digest"] = load_document(self.campaign).digest
        if not self.evidence["files"].keys().isdisjoint({*self.FILES, "evaluations.npz"}):
            self.write()
        for name in self.evidence["files"]:
            self.evidence["files"][name] = hashlib.sha256((self.path / name).read_bytes()).hexdigest()
        raw = {"result": {k: v for k, v in self.result.items() if k != "evidence_digest"}, **self.evidence}
        positions = sorted(int(name[7:]) for name in self.arrays if name.startswith("status_"))
        rows = [Rows.of(k, *(self.arrays[f"{c}_{k}"] for c in ("points", "costs", "status"))) for k in positions]
        self.result["evidence_digest"] = evidence_digest(digest_of(self.campaign), rows, json.loads(json.dumps(raw)))
        self.write()

    def forget_seal(self) -> None:
        """The record as a version before the evidence digest wrote it."""
        self.result.pop("evidence_digest", None)
        self.evidence.pop("files", None)

    def forget_spans(self) -> None:
        """The record as a version before spans wrote it: text only, in the words of that version."""
        self.forget_seal()
        for name in ("statement", "holds_for", "values", "sentence", "scope"):
            del self.result[name]
        for check in self.result["checks"]:
            del check["statement"], check["values"], check["code"], check["limit"]
        self.result["reason"] = self.result["reason"].replace(" samples drawn ", " flights drawn ")

    def fail_another_check(self) -> None:
        statement = [{"kind": "text", "text": "the tether is slack"}]
        self.result["checks"].append(
            {"name": "tether", "code": "tether", "ok": False, "text": "the tether is slack", "statement": statement}
        )

    def withdraw_a_draw(self) -> None:
        """Take the last draw of the sample out, and make every count fit."""
        row = len(self.arrays[f"status_{CERTIFY}"]) - GRID - 1
        for name in ("points", "costs", "status", "seconds"):
            self.arrays[f"{name}_{CERTIFY}"] = np.delete(self.arrays[f"{name}_{CERTIFY}"], row, axis=0)
        sample = self.evidence["results"][CERTIFY]["sample"]
        for held in (self.evidence["results"][CERTIFY], self.result["stages"][CERTIFY]):
            held["evaluations"] -= 1
        for held in (sample, self.result["statistics"]):
            held["samples"] -= 1


def edit(path: str, to: Any) -> Callable[[Folder], None]:
    return lambda folder: folder.set(path, to)


def say(old: str, new: str) -> Callable[[Folder], None]:
    """Other words, of a record that has words alone."""

    def change(folder: Folder) -> None:
        folder.forget_spans()
        folder.reword(old, new)

    return change


def reword(old: str, new: str) -> Callable[[Folder], None]:
    return lambda folder: folder.reword(old, new)


def lie(name: str, value: float) -> Callable[[Folder], None]:
    return lambda folder: folder.lie(name, value)


def restate(old: str, new: str) -> Callable[[Folder], None]:
    return lambda folder: folder.restate(old, new)


NOMINAL, SAMPLE_ = "evidence/results/5/nominal", "evidence/results/4/sample"

DEVIATION = "campaign/uncertain/vehicle.m/distribution/deviation"

ENCOUNTER = "evidence/results/5/encounter"

FINDING, STATISTICS = "result/findings/0", "result/statistics"

CORRUPTIONS: list[tuple[str, str, Callable[[Folder], Any], str]] = [
    ("a part with another best", "alone", edit("evidence/results/2/apart/1/best", 0.1), "results.2.apart.1.best"),
    ("a part with another evaluation", "alone", edit("evidence/results/2/apart/1/index", 3), "results.2.apart.1.best"),
    ("a part that is none", "alone", edit("evidence/results/2/apart/1/member", "sqp"), "results.2.apart.count"),
    (
        "a part of another family",
        "alone",
        edit("evidence/results/2/apart/1/family", "other"),
        "results.2.apart.1.family",
    ),
    (
        "a part of too many evaluations",
        "alone",
        edit("evidence/results/2/apart/1/evaluations", 299),
        "results.2.apart.count",
    ),
    ("a changed cost", "cleared", lambda f: f.arrays["costs_2"].__setitem__((7, 0), 0.3), "evaluations.lowest"),
    ("violations hidden", "violated", lambda f: f.arrays["costs_2"].clip(1, out=f.arrays["costs_2"]), "stages.2.best"),
    ("a dropped evaluation", "cleared", lambda f: f.shorten(2), "evaluations.stored"),
    ("a changed status", "cleared", edit("arrays/status_2/3", 1), "evaluations.failed"),
    (
        "an excluded flag turned ok",
        "excluded",
        lambda f: f.arrays["status_2"].clip(0, 0, f.arrays["status_2"]),
        "sound",
    ),
    ("a wrong count in the summary", "cleared", edit("result/evaluations/succeeded", 9), "evaluations.succeeded"),
    ("a wrong count of violations", "violated", edit("result/evaluations/violating", 0), "evaluations.violating"),
    ("a wrong count of a stage", "cleared", edit("result/stages/2/evaluations", 999), "stages.2.evaluations"),
    ("a wrong count in the sentence", "cleared", say(" evaluations, f", "0 evaluations, f"), "sentence.evaluations"),
    ("a wrong count of a method", "cleared", say("DIRECT (100)", "DIRECT (1000)"), "sentence.methods"),
    ("a method left out", "violated", say(" and Monte Carlo (60)", ""), "sentence.methods"),
    ("a wrong bound in the sentence", "cleared", say("is at most ", "is at most 0.0"), "sentence.upper_bound"),
    ("another worst in the sentence", "cleared", say("d_min = 0.9", "d_min = 1.9"), "sentence.worst"),
    ("another threshold in the sentence", "cleared", say("above 0.5 m", "above 0.9 m"), "sentence.threshold"),
    ("a sentence of another verdict", "violated", say("falls to or below", "stayed above"), "sentence.opening"),
    ("words that are not the spans'", "cleared", reword(" evaluations, f", "0 evaluations, f"), "sentence.words"),
    ("a bound that is not the spans'", "cleared", reword("is at most ", "is at most 0.0"), "sentence.words"),
    ("another verdict in words", "violated", reword("falls to or below", "stayed above"), "sentence.words"),
    ("a wider scope", "cleared", edit("result/holds_for/0/text", "Everything"), "sentence.words"),
    ("a false count", "cleared", lie("evaluations", 9999), "sentence.evaluations"),
    ("a false worst", "cleared", lie("worst", 1.9), "sentence.worst"),
    (
        "a worst that is written alike",
        "cleared",
        lambda f: f.lie("worst", f.result["worst"]["cost"] + 1e-8),
        "sentence.worst",
    ),
    ("a false margin", "violated", lie("margin", 0.1), "sentence.margin"),
    ("a false threshold", "cleared", lie("threshold", 0.9), "sentence.threshold"),
    ("a false bound", "cleared", lie("upper_bound", 0.001), "sentence.upper_bound"),
    ("a false count of violations", "violated", lie("violating", 1), "sentence.violating"),
    ("a false count of draws", "cleared", lie("samples", 3000), "sentence.samples"),
    ("a false count of a method", "cleared", lie("searched.direct", 1000), "sentence.methods"),
    ("a method under another name", "cleared", restate("DIRECT", "Everything"), "sentence.methods"),
    ("a sentence of another opening", "violated", restate("falls to or below", "stayed above"), "sentence.opening"),
    ("a check in other words", "cleared", edit("result/checks/0/text", "all is well"), "sentence.checks.nominal"),
    ("violated changed to cleared", "violated", edit("result/verdict", "cleared"), "verdict"),
    ("inconclusive changed to cleared", "inconclusive", edit("result/verdict", "cleared"), "verdict"),
    ("cleared changed to violated", "cleared", edit("result/verdict", "violated"), "verdict"),
    (
        "a check turned ok",
        "inconclusive",
        lambda f: [c.update(ok=True) for c in f.result["checks"]],
        "checks.agreement",
    ),
    ("a lowered threshold", "violated", edit("campaign/criterion/threshold", 0.1), "verdict"),
    ("a threshold that fits no margin", "cleared", edit("campaign/criterion/threshold", 0.1), "nominal.margin"),
    ("a changed bound", "cleared", edit(f"{STATISTICS}/upper_bound", 1e-6), "statistics.upper_bound"),
    ("a changed bound of a stage", "cleared", edit(f"{SAMPLE_}/upper_bound", 1e-6), "results.4.sample.upper_bound"),
    ("another probability outside", "cleared", edit(f"{SAMPLE_}/outside", 0.0), "results.4.sample.outside"),
    ("a changed quantile", "cleared", edit(f"{STATISTICS}/quantile/bound", 0.95), "statistics.quantile.bound"),
    ("a changed order", "cleared", edit(f"{SAMPLE_}/quantile/order", 7), "results.4.sample.quantile.order"),
    ("a changed confidence", "cleared", edit("campaign/confidence", 0.6), "results.4.sample.confidence"),
    ("a shortened sample", "cleared", Folder.withdraw_a_draw, "statistics.samples"),
    ("a sample without noise", "noisy", edit("evidence/results/4/drawn_realisations", 0), "checks.noise"),
    ("a changed cost of a finding", "cleared", edit(f"{FINDING}/cost", 0.95), "findings.0.cost"),
    ("a finding that was not evaluated", "cleared", edit(f"{FINDING}/point/0", 0.123), "findings.0.cost"),
    ("a finding removed", "violated", lambda f: f.result["findings"].pop(), "comparison.0.findings.count"),
    ("a finding at no bound", "cleared", edit(f"{FINDING}/at_bounds", {}), "findings.0.at_bounds"),
    ("a less likely finding", "cleared", edit(f"{FINDING}/likelihood/distance", 9.0), "findings.0.likelihood.distance"),
    ("a likelihood removed", "cleared", lambda f: f.result["findings"][0].pop("likelihood"), "findings.0.likelihood"),
    (
        "fewer violations",
        "violated",
        edit("result/most_likely_violation/violations", 1),
        "most_likely_violation.violations",
    ),
    ("no likely violation", "cleared", lambda f: f.result.pop("most_likely_violation"), "most_likely_violation"),
    ("another parameter", "cleared", edit(f"{FINDING}/parameters/vehicle.m", 5.9), "findings.0.parameters.vehicle.m"),
    ("another worst cost", "cleared", edit("result/worst/cost", 0.95), "worst.cost"),
    ("a changed case", "cleared", edit(f"{NOMINAL}/integrator/cost", 0.2), "results.5.nominal.ok"),
    ("a changed case of a finding", "violated", edit(f"{FINDING}/validation/half_step/cost", 0.95), "verdict"),
    ("a case of no finding", "cleared", edit("result/findings/0/validation/cost", 0.95), "findings.0.validation.cost"),
    ("a wider tolerance", "cleared", edit(f"{NOMINAL}/allowed", 0.5), "results.5.nominal.allowed"),
    ("a spot check violates", "cleared", edit("evidence/results/5/spot_checks/violating", 1), "checks.validation"),
    ("few spot checks", "cleared", edit("evidence/results/5/spot_checks/checked", 1), "results.5.spot_checks.checked"),
    ("unseen violations", "violated", edit("evidence/results/5/violations/checked", 0), "results.5.violations.checked"),
    ("unfinished findings", "cleared", edit("evidence/results/5/findings/complete", False), "checks.minimum"),
    ("an encounter at the end", "cleared", edit("result/findings/0/closest/at", "end"), "checks.closest approach"),
    ("a later encounter", "cleared", edit(f"{ENCOUNTER}/beyond/closer", 1), "checks.closest approach"),
    (
        "a later encounter of no flight",
        "cleared",
        edit(f"{ENCOUNTER}/beyond/lowest", {"value": 0.1}),
        "checks.closest approach",
    ),
    (
        "few flights simulated on",
        "cleared",
        edit(f"{ENCOUNTER}/beyond/flights", 2),
        "results.5.encounter.beyond.flights",
    ),
    (
        "more flights that fail after the horizon than were simulated on",
        "cleared",
        edit(f"{ENCOUNTER}/beyond/cut_short", 10**6),
        "results.5.encounter.beyond.cut_short",
    ),
    ("a vehicle that stands still", "cleared", edit(f"{ENCOUNTER}/moved", 0.0), "checks.motion"),
    ("an avoidance without effect", "cleared", edit(f"{ENCOUNTER}/unseen/cost", 0.95), "checks.avoidance"),
    ("a best in no basin", "cleared", edit("result/comparison/0/basin", None), "checks.agreement"),
    ("a better best", "cleared", edit("result/comparison/0/best", 0.9), "comparison.0.best"),
    ("another end of a search", "cleared", edit("evidence/results/2/stop/kind", "rule"), "results.2.stop.kind"),
    ("a changed distribution", "cleared", edit(DEVIATION, 0.1), "digests.result"),
    ("a distribution with another bound", "cleared", edit(DEVIATION, 0.1), "statistics.upper_bound"),
    ("another method", "cleared", edit("campaign/stages/search/0/method", "ga"), "stages.2.method"),
    ("a point outside the bounds", "cleared", lambda f: f.arrays["points_2"].__setitem__((3, 0), 1.5), "placed"),
    ("an unknown status", "cleared", edit("arrays/status_2/3", 9), "sound"),
    ("an evaluation of no stage", "cleared", lambda f: f.result["stages"].pop(), "stages.count"),
    (
        "a finding listed twice",
        "cleared",
        lambda f: f.result["findings"].append(f.result["findings"][0]),
        "findings.1.label",
    ),
    ("no findings", "cleared", edit("result/findings", []), "checks.minimum"),
    ("no statistics", "cleared", edit("result/statistics", None), "statistics"),
    ("no checks", "cleared", edit("result/checks", []), "verdict"),
    ("a check of another package that fails", "cleared", Folder.fail_another_check, "verdict"),
    ("a cost of another type", "cleared", edit("result/worst/cost", "0.94"), "worst.cost"),
    ("a cost that is NaN", "cleared", edit("result/worst/cost", float("nan")), "worst.cost"),
]

UNREADABLE: list[tuple[str, str, Callable[[Folder], Any]]] = [
    ("a finding of fewer parameters", "violated", lambda f: f.result["findings"][0]["point"].pop()),
    ("a finding of no cost", "violated", edit(f"{FINDING}/cost", None)),
    ("another seed, without the counts", "cleared", lambda f: (f.campaign.update(seed=9), f.result.pop("evaluations"))),
    ("no results", "cleared", edit("evidence/results", [])),
]
"""Changes after which a record is not that of a run."""

UNKNOWN: list[tuple[str, str, Callable[[Folder], Any]]] = [
    ("a nominal case that is not evaluated again", "cleared", edit("evidence/results/5/nominal", None)),
    ("no components", "cleared", lambda f: f.evidence.pop("components")),
]
"""Changes after which it is not known whether the verdict follows."""

LAST, MEASURED = "evidence/results/5", "evidence/results/0/measured"

REPEATS, BEST = f"{LAST}/incumbents/0/validation/repeats", "results.5.incumbents"

CALLS: list[tuple[str, str, Callable[[Folder], Any], str]] = [
    ("differs", "one more digit", lambda f: f.arrays["costs_0"].__setitem__((7, 0), 9.0), "results.0.measured.spread"),
    ("differs", "called identical", edit(f"{MEASURED}/identical", True), "results.0.measured.identical"),
    ("differs", "a smaller spread", edit(f"{MEASURED}/spread", 1e-9), "results.0.measured.spread"),
    ("differs", "changed to cleared", edit("result/verdict", "cleared"), "verdict"),
    (
        "differs",
        "a check turned ok",
        lambda f: [c.update(ok=True) for c in f.result["checks"]],
        "checks.noise of calls",
    ),
    ("calls", "a call that violates", edit(f"{REPEATS}/values/3", 0.5), "checks.noise of calls"),
    ("calls", "a call that fails", edit(f"{REPEATS}/values/3", None), f"{BEST}.0.validation.repeats.failed"),
    (
        "calls",
        "fewer calls",
        lambda f: f.best[0]["validation"]["repeats"]["values"].pop(),
        "checks.noise of calls",
    ),
    ("calls", "another interval", edit(f"{REPEATS}/high", 0.01), f"{BEST}.0.validation.repeats.high"),
    ("calls", "an incumbent left out", lambda f: f.best.pop(), f"{BEST}.count"),
    ("calls", "combined by the mean", edit("campaign/simulator/repeats/combine", "mean"), "checks.noise of calls"),
    ("calls", "a sample of stated calls", edit("result/statistics/noise", "stated"), "statistics.noise"),
    (
        "violated",
        "fewer violating calls",
        edit("result/findings/2/validation/repeats/violating", 0),
        "findings.2.validation.repeats.violating",
    ),
    ("retried", "a call not tried again", lambda f: f.arrays.__setitem__("reasons_2", np.array("{}")),
     "evaluations.flaky"),
    ("retried", "no call tried again", edit("result/evaluations/flaky", 0), "evaluations.flaky"),
]  # fmt: skip


@once
def called(name: str) -> tuple[Campaign, MemoryStore]:
    """A run of a simulator that does not repeat; that of `auto` alone, of one that does."""
    how = {"violated": "rarely a violation", "retried": "none", "alone": "none"}.get(name, "a coin")
    lost = (lambda call: FAILED if call.total % 7 == 0 else OK) if name == "retried" else None
    asked = {"differs": {}, "retried": {"retries": 2}, "alone": {}}.get(name, noisy.REPEATS)
    campaign = noisy.by_auto() if name == "alone" else noisy.campaign(**asked)
    store = MemoryStore(sample_seed=DRAWN)
    with adversary(how, lost):
        execute(campaign, store, threads=1)
    return campaign, store


def write_called(folder: Path, name: str) -> Path:
    """That run as `clearance run --out` writes it."""
    return copied(files_called(name), folder)


@once
def files_called(name: str) -> dict[str, bytes]:
    """The files of the record, written once for all tests."""
    campaign, store = called(name)
    with adversary():
        return made(campaign, store)
