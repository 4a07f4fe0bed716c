"""Forgeries of a stored run by whoever can compute every digest again. Start reading at `FORGERIES`."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from campaigns import CampaignError
from campaigns.claims.spans import words
from campaigns.claims.stages import estimate as templates
from campaigns.claims.stages import surroundings
from campaigns.identity.identity import identity_of
from campaigns.results.base import EXCLUDED
from campaigns.versions import Versions
from tests.given.corrupted_records import CERTIFY, ENCOUNTER, FINDING, GRID, SAMPLE_, STATISTICS, Folder, edit
from worker.evidence.audit.judge import closing
from worker.evidence.audit.record import UnreadableError
from worker.evidence.audit.sentences import SPANS
from worker.evidence.audit.trusted import TRUSTED

ESTIMATE = 3
ESTIMATE_ = f"evidence/results/{ESTIMATE}"
"""The estimate of the run with one."""
ATTRACTION_ = "evidence/results/3"
"""The region of attraction of the run with one."""
BOLD = " No worse case exists."
LAST = 4
"""The position of the last stage of the run with excluded evaluations."""
COLUMNS = ("points", "costs", "status", "seconds")


class Forgery(NamedTuple):
    """A change of the record of a run; trusted: the path of what is taken as given, if it is accepted."""

    text: str
    run: str
    change: Callable[[Folder], Any]
    trusted: str = ""


def _ten_times(folder: Folder) -> None:
    """The sample ten times over, in a campaign that asks for it, with counts that fit."""
    draws = len(folder.arrays[f"status_{CERTIFY}"]) - GRID
    for name in COLUMNS:
        rows = folder.arrays[f"{name}_{CERTIFY}"]
        folder.arrays[f"{name}_{CERTIFY}"] = np.concatenate([*[rows[:draws]] * 10, rows[draws:]])
    folder.campaign["stages"]["certify"]["samples"] *= 10
    for stated in (folder.evidence["results"][CERTIFY]["sample"], folder.result["statistics"]):
        stated["samples"] *= 10
        stated["upper_bound"] = 0.00199


def _another_draw(folder: Folder) -> None:
    folder.arrays[f"points_{CERTIFY}"][5] = folder.arrays[f"points_{CERTIFY}"][6]


def _ordered(folder: Folder) -> None:
    for name in COLUMNS:
        rows = folder.arrays[f"{name}_{CERTIFY}"]
        rows[: len(rows) - GRID] = rows[: len(rows) - GRID][::-1].copy()


def _bold(*path: Any) -> Callable[[Folder], None]:
    """The same words at the end of a sentence, in its spans and as written."""

    def change(folder: Folder) -> None:
        value, *keys = path
        stated: Any = vars(folder)[value]
        for key in keys:
            stated = stated[key]
        spans = stated["statement"]
        spans.append({"kind": "text", "text": BOLD})
        if "text" in stated:
            stated["text"] += BOLD
        if value == "result" and not keys:
            stated["sentence"] += BOLD
            folder.render()

    return change


def _less_likely(folder: Folder) -> None:
    """Consistent numbers and words."""
    stated = folder.evidence["results"][ESTIMATE]
    for name in ("probability", "low", "high"):
        stated[name] /= 1000
    for span in stated["statement"]:
        if span.get("name") in ("probability", "low", "high"):
            span["value"] /= 1000
    stated["text"] = words(SPANS.validate_python(stated["statement"]))


def _nothing_estimated(folder: Folder) -> None:
    """As if no violation had been known."""
    stated = folder.evidence["results"][ESTIMATE]
    why = templates.NO_VIOLATION
    told = [span.model_dump(mode="json") for span in templates.refused(why)]
    for name in ("density", "independent", "final"):
        del stated[name]
    stated |= dict.fromkeys(("probability", "low", "high", "variation", "effective"))
    stated |= {"draws": 0, "failed_draws": 0, "modes": [], "alarms": []}
    refused = {"why": "no_violation", "limit": 0, "statement": [span.model_dump(mode="json") for span in why]}
    stated |= {"refused": refused | {"text": words(why)}, "statement": told, "text": words(templates.refused(why))}


def _digit(place: str) -> Callable[[Folder], None]:
    """The last digit of a number of the proof."""

    def change(folder: Folder) -> None:
        *above, last = place.split("/")
        held: Any = folder.evidence["results"][3]["proof"]
        for key in above:
            held = held[int(key)] if isinstance(held, list) else held[key]
        held[int(last)] = str(int(held[int(last)]) + 1)

    return change


def _doubled(place: str) -> Callable[[Folder], None]:
    """All numbers of a part of the proof half as large."""

    def change(folder: Folder) -> None:
        held: Any = folder.evidence["results"][3]["proof"]
        for key in place.split("/"):
            held = held[key]
        held["bits"] += 1

    return change


def _slower_loop(folder: Folder) -> None:
    """A coefficient of the model, by a thousandth."""
    numbers = folder.evidence["results"][3]["flow"][1]["coefficients"]["numbers"]
    numbers[0] = str(int(numbers[0]) * 1001 // 1000)


def _surer(folder: Folder) -> None:
    """Another chance, in the sentence, too."""
    stated = folder.result["sureness"]
    for span in stated["statement"]:
        if span.get("name") == "chance":
            span["value"] = 0.011
    stated |= {"chance": 0.011, "text": words(SPANS.validate_python(stated["statement"]))}


def _sure(folder: Folder) -> None:
    folder.result["sureness"] = {"chance": 0.01, "lower": 0.1, "landscapes": 100, "statement": [], "text": ""}


def _scope(old: str, new: str) -> Callable[[Folder], None]:
    def change(folder: Folder) -> None:
        text = json.dumps(folder.result["holds_for"])
        assert old in text
        folder.result["holds_for"] = json.loads(text.replace(old, new))
        folder.render()
        folder.result["scope"] = folder.result["reason"][folder.result["reason"].index("Scope: ") :]

    return change


def _cost(folder: Folder) -> None:
    """Another cost of an evaluation that no claim rests on, in the table, too."""
    cost, table = folder.arrays["costs_2"], folder.path / "evaluations.csv"
    before, cost[7, 0] = repr(float(cost[7, 0])), 0.9431
    rows = table.read_text(encoding="utf-8").splitlines(keepends=True)
    (k,) = [k for k, row in enumerate(rows) if row.startswith("2,search,direct,7,")]
    rows[k] = rows[k].replace(before, "0.9431")
    table.write_text("".join(rows), encoding="utf-8")


def _unit(folder: Folder) -> None:
    for span in folder.result["statement"]:
        if span.get("unit") == "m":
            span["unit"] = "km"
    folder.render()
    folder.result["sentence"] = folder.result["reason"].partition(" Scope: ")[0]


def _without(name: str) -> Callable[[Folder], None]:
    def change(folder: Folder) -> None:
        before = len(folder.result["checks"])
        folder.result["checks"] = [c for c in folder.result["checks"] if c["name"] != name]
        assert len(folder.result["checks"]) < before

    return change


def _mismeasured(folder: Folder) -> None:
    """A criterion that does not compute the distance that it declares."""
    at = {"obstacle": 0, "time": 0.0, "position": [1.0, 2.0], "distance": -0.05, "value": 0.45}
    folder.evidence["results"][5]["encounter"]["mismeasured"] = at


def _never(folder: Folder) -> None:
    """A fault that begins after the end of every flight, and a check that holds."""
    folder.evidence["results"][5]["encounter"]["begins"] = {"faults.0": [1e3, 2e3]}


def _partly(folder: Folder) -> None:
    """A fault that still builds up at the end of every flight, and a check that holds."""
    folder.evidence["results"][5]["encounter"]["whole"] = {"faults.0": [1e3, 2e3]}


def _approaching(folder: Folder) -> None:
    """An obstacle with states that approaches at the end of what is known of it, and a check that holds."""
    later = {
        "name": "F1",
        "value": 1.2,
        "time": 3.0,
        "obstacle": 0,
        "distance": 4.0,
        "closing": 1.0,
        "simulated": False,
    }
    folder.evidence["results"][5]["encounter"]["beyond"]["unknown"] = later


def _family(folder: Folder) -> None:
    for method in folder.evidence["components"]["methods"]:
        method["family"] = f"that of {method['name']}"


def _table(edit_row: Callable[[list[str]], list[str]], line: int) -> Callable[[Folder], None]:
    """An edit of a line of the table of evaluations, the header included."""

    def change(folder: Folder) -> None:
        table = folder.path / "evaluations.csv"
        lines = table.read_text(encoding="utf-8").splitlines()
        lines[line] = ",".join(edit_row(lines[line].split(",")))
        table.write_text("\n".join(lines) + "\n", encoding="utf-8")

    return change


def _trajectory_unit(folder: Folder) -> None:
    file = folder.path / "trace-F1.csv"
    header, rest = file.read_text(encoding="utf-8").split("\n", 1)
    assert "[m]" in header
    file.write_text(header.replace("[m]", "[km]") + "\n" + rest, encoding="utf-8")


def _trajectory(folder: Folder) -> None:
    (folder.path / "trace-F9.csv").write_bytes((folder.path / "trace-F1.csv").read_bytes())
    folder.evidence["files"]["trace-F9.csv"] = ""


def _other_code(folder: Folder) -> None:
    versions = folder.result["versions"] | {"code": "0" * 64}
    made = identity_of(Versions.of(versions), "").model_dump(mode="json")
    folder.result |= {"versions": versions, "identity": made}


def _excluded_that_is_ok(folder: Folder) -> None:
    """One more evaluation with a harmless cost, in the counts and in the table, too."""
    row = int(np.flatnonzero(folder.arrays[f"status_{LAST}"] == EXCLUDED)[0])
    cost = float(np.nanmedian(folder.arrays[f"costs_{LAST}"]))
    folder.arrays[f"status_{LAST}"][row], folder.arrays[f"costs_{LAST}"][row] = 0, cost
    line = 1 + row + sum(len(folder.arrays[f"status_{at}"]) for at in range(LAST))
    _table(lambda cells: [*cells[:4], "ok", repr(cost), *cells[6:8], ""], line)(folder)
    for counted in (folder.result["evaluations"], folder.result["stages"][LAST]):
        counted["excluded"] -= 1
    folder.result["evaluations"]["succeeded"] += 1
    folder.evidence["results"][LAST]["encounter"]["spread"]["evaluations"] += 1


def _without_a_stage(folder: Folder) -> None:
    """A run of a campaign without the sensitivity stage, of which nothing is left."""
    folder.campaign["stages"]["sensitivity"] = None
    gone = len(folder.arrays["status_1"])
    del folder.evidence["results"][1], folder.result["stages"][1]
    names = [name.rsplit("_", 1) for name in folder.arrays]
    moved = {f"{name}_{int(at) - (at > '1')}": folder.arrays[f"{name}_{at}"] for name, at in names if at != "1"}
    folder.arrays = moved
    last = folder.evidence["results"][-1]
    found = [one for finding in folder.result["findings"] for one in finding["found"]]
    for one in [*folder.result["comparison"], *last["comparison"], *found, last["spot_checks"]["at"]]:
        one["position"] -= 1
    counts = folder.result["evaluations"]
    before, total = counts["stored"], counts["stored"] - gone
    counts |= {"stored": total, "succeeded": total}
    last["encounter"]["spread"]["evaluations"] = total
    beyond = last["encounter"]["beyond"]
    of = "not_continued" if beyond["not_continued"] else "flights"
    now = {before: total, beyond[of]: beyond[of] - gone}
    beyond[of] -= gone
    folder.lie("evaluations", float(total))
    folder.result["values"]["evaluations"] = float(total)
    folder.result["sentence"] = folder.result["reason"].partition(" Scope: ")[0]
    for check in folder.result["checks"]:
        for span in check["statement"]:
            if span.get("value") in now:
                span["value"] = float(now[span["value"]])
                if span["name"]:
                    check["values"][span["name"]] = span["value"]
        check["text"] = words(SPANS.validate_python(check["statement"]))
    table = folder.path / "evaluations.csv"
    header, *rows = table.read_text(encoding="utf-8").splitlines()
    kept = [row.split(",", 1) for row in rows if not row.startswith("1,")]
    text = [header, *(f"{int(at) - (at > '1')},{rest}" for at, rest in kept)]
    table.write_text("\n".join(text) + "\n", encoding="utf-8")


def _misplaced(folder: Folder) -> None:
    """The honest result beside the evidence, where the audit looks, and another one where people do."""
    folder.evidence |= {name: folder.result[name] for name in ("verdict", "sentence", "worst")}
    folder.result |= {"verdict": "cleared", "sentence": "No worse case exists."}


def _twice(folder: Folder) -> None:
    folder.result["checks"].insert(0, folder.result["checks"][0] | {"title": "Proof", "text": "no worse case exists"})


def _by_another(folder: Folder) -> None:
    """The worst case as found by the sample, with its first evaluation."""
    stated = {"position": SEARCHED, "method": "monte_carlo", "evaluations": 1}
    folder.result["findings"][0] |= {"found": [stated], "methods": ["monte_carlo"]}
    folder.result["worst"]["method"] = "monte_carlo"
    for compared in (folder.result["comparison"], folder.evidence["results"][-1]["comparison"]):
        for row in compared:
            row["findings"] = ["F1"] if row["position"] == SEARCHED else []


def _doubly(folder: Folder) -> dict[str, Any]:
    return {"found": folder.result["findings"][0]["found"] * 2}


def _unlikely(folder: Folder) -> None:
    folder.result.pop("most_likely_violation", None)
    for finding in folder.result["findings"]:
        del finding["likelihood"]


def _named(path: str, value: Any) -> Callable[[Folder], None]:
    """A value under a name that no record has."""

    def change(folder: Folder) -> None:
        part, *above, last = path.split("/")
        stated: Any = vars(folder)[part]
        for key in above:
            stated = stated[int(key)] if isinstance(stated, list) else stated[key]
        assert last not in stated
        stated[last] = value

    return change


SEARCHED = 4
"""The position of the sample among the searches of the violated run."""


def _told(folder: Folder, old: str, new: str) -> None:
    """Other words of the verdict where it names what is forged."""
    if any(old in (span.get("text") or "") for span in folder.result["statement"]):
        folder.restate(old, new)


def _another_noise(folder: Folder) -> None:
    """Of the finding with its own noise, wherever it is named."""
    case = folder.result["findings"][0]["validation"]
    _told(folder, f"seed {case['realisation']}", "seed 777")
    case["realisation"] = 777


def _no_noise(folder: Folder) -> None:
    case = folder.result["findings"][0]["validation"]
    _told(folder, f", with the noise realisation of seed {case['realisation']}", "")
    case["realisation"] = None


def _above_nothing(folder: Folder) -> None:
    """A lower bound of DIRECT close to a value that no evaluation has, in its sentence as well."""
    gap = folder.evidence["results"][2]["gap"]
    gap |= {"lower_bound": 1.9, "gap": 1e-9}
    stated = surroundings.possible_gain(gap["rectangles"], gap["without_value"], "d_min", 1.9, 1.9 + 1e-9, "m")
    gap |= {"statement": [span.model_dump(mode="json") for span in stated], "text": words(stated)}


def _other_reason(folder: Folder) -> None:
    """In the table alone."""
    table = folder.path / "evaluations.csv"
    text = table.read_text()
    other = text.replace("so avoidance cannot be tested", "the operator excluded it", 1)
    assert other != text
    table.write_text(other)


def _failure(folder: Folder) -> None:
    lost = {"status": "timeout", "reason": "power cut", "stage": 2, "index": 9, "output": "", "evaluations": 1}
    folder.result["failures"] = [lost]


FORGERIES: list[Forgery] = [
    Forgery("the honest result in the other file", "violated", _misplaced),
    Forgery("results in both files", "violated", lambda f: f.result.__setitem__("results", f.evidence["results"])),
    Forgery("a check stated twice", "inconclusive", _twice),
    Forgery("checks in another order", "inconclusive", lambda f: f.result["checks"].reverse()),
    Forgery("a finder that was nowhere near", "violated", _by_another),
    Forgery("a finder twice", "violated", lambda f: f.result["findings"][0].update(_doubly(f))),
    Forgery("findings without their likelihood", "violated", _unlikely),
    Forgery("more spot checks than were made", "violated", edit("evidence/results/-1/spot_checks/compared", 10**6)),
    Forgery("more confirmed than checked", "violated", edit("evidence/results/-1/violations/confirmed", 500)),
    Forgery("a bolder end of the findings", "violated", _bold("evidence", "results", -1, "findings")),
    Forgery("a proof beside the worst case", "violated", _named("result/worst/proof", "no worse case exists")),
    Forgery("a proof beside the counts", "violated", _named("result/evaluations/proved", 1)),
    Forgery("a proof beside a finding", "violated", _named("result/findings/0/validation/proved", True)),
    Forgery("a proof beside a stage", "violated", _named("result/stages/2/claim", "exhaustive")),
    Forgery("a proof beside a result", "violated", _named("evidence/results/2/exact", "P = 0")),
    Forgery("a proof beside a check", "violated", _named("result/checks/0/proof", "yes")),
    Forgery("a sample stored ten times", "cleared", _ten_times),
    Forgery("a draw stored twice", "cleared", _another_draw),
    Forgery("a sample in another order", "cleared", _ordered),
    Forgery("another seed of the sample", "cleared", edit(f"evidence/results/{CERTIFY}/seed", 9)),
    Forgery("a seed that is not the campaign's", "cleared", edit("result/seed", 9)),
    Forgery("another nominal point", "cleared", lambda f: f.arrays["points_0"].__setitem__((0, 0), 0.51)),
    Forgery("another point of the grid", "cleared", lambda f: f.arrays[f"points_{CERTIFY}"].__setitem__((-2, 0), 0.4)),
    Forgery("no worse case exists", "cleared", _bold("result")),
    Forgery("a bolder check", "cleared", _bold("result", "checks", 0)),
    Forgery("a bolder sample", "cleared", _bold("evidence", "results", CERTIFY, "sample")),
    Forgery("a bolder certificate", "cleared", _bold("evidence", "results", CERTIFY)),
    Forgery("a bolder grid", "cleared", _bold("evidence", "results", CERTIFY, "grid")),
    Forgery("a bolder validation", "cleared", _bold("evidence", "results", 5)),
    Forgery("bolder statistics", "cleared", _bold("result", "statistics")),
    Forgery("a wider bound in the scope", "cleared", _scope('"value": 6.0', '"value": 60.0')),
    Forgery("another horizon in the scope", "cleared", _scope('"value": 4.0', '"value": 40.0')),
    Forgery("another step in the scope", "cleared", _scope('"value": 0.005', '"value": 0.0005')),
    Forgery("more obstacles in the scope", "cleared", _scope("1 obstacle", "9 obstacles")),
    Forgery("another vehicle in the scope", "cleared", _scope("nicycle", "ny vehicle")),
    Forgery("another unit in the sentence", "cleared", _unit),
    Forgery("no check of agreement", "inconclusive", _without("agreement")),
    Forgery("no check of the encounter", "cleared", _without("closest approach")),
    Forgery("no check of the bound", "cleared", _without("probability")),
    Forgery("another title of a check", "cleared", edit("result/checks/0/title", "Proof")),
    Forgery("an open check that holds", "inconclusive", edit("result/checks/0/standing", "open")),
    Forgery("the worst parameters", "cleared", edit("result/worst/parameters/vehicle.m", 4.4)),
    Forgery("the worst as evaluated", "cleared", edit("result/worst/evaluated", 0.97)),
    Forgery("families of methods", "inconclusive", _family),
    Forgery("the family of a search", "cleared", edit("evidence/results/2/family", "another one")),
    Forgery("another chance of a lower case", "alone", _surer),
    Forgery("no chance of a lower case", "alone", lambda f: f.result.pop("sureness")),
    Forgery("a chance where nothing is known of it", "cleared", _sure),
    Forgery("a smaller difference of a lower case", "alone", edit("result/sureness/lower", 1e-6)),
    Forgery("more landscapes", "alone", edit("result/sureness/landscapes", 10**6)),
    Forgery("a bolder chance of a lower case", "alone", _bold("result", "sureness")),
    Forgery("a mean of the sample", "cleared", edit(f"{SAMPLE_}/mean", 1.2)),
    Forgery("a deviation of the sample", "cleared", edit(f"{SAMPLE_}/deviation", 1e-3)),
    Forgery("a histogram", "cleared", edit(f"{SAMPLE_}/histogram/counts/0", 77)),
    Forgery("a distribution function", "cleared", edit(f"{SAMPLE_}/distribution/values/0", 0.99)),
    Forgery("a smaller sample that suffices", "cleared", edit(f"{SAMPLE_}/quantile/needed", 3)),
    Forgery("a quantile of the statistics", "cleared", edit(f"{STATISTICS}/quantile/share", 0.5)),
    Forgery("a curve", "cleared", edit("evidence/results/1/curves/0/costs/0", 1.5)),
    Forgery("a slice", "cleared", edit(f"{FINDING}/slices/curves/0/costs/3", 1.5)),
    Forgery("a minimum", "cleared", edit("evidence/results/3/minima/0/cost", 1.5)),
    Forgery("the best of a search", "cleared", edit("evidence/results/2/best/index", 3)),
    Forgery("a method that did not find it", "cleared", edit(f"{FINDING}/found/0/method", "ga")),
    Forgery("the step of a validation", "cleared", edit(f"{FINDING}/validation/half_step/step", 1e-6)),
    Forgery("the distance of findings", "cleared", edit("evidence/results/5/findings/distance", 0.5)),
    Forgery("a value that is absent", "cleared", lambda f: f.result["statistics"].pop("upper_bound")),
    Forgery("a count that is absent", "violated", lambda f: f.result["evaluations"].pop("violating")),
    Forgery("a result that is absent", "cleared", lambda f: f.evidence["results"].__setitem__(2, None)),
    Forgery("flights beyond the horizon", "cleared", edit(f"{ENCOUNTER}/beyond/flights", 10**6)),
    Forgery("no flight beyond the horizon", "cleared", lambda f: f.evidence["results"][5]["encounter"].pop("beyond")),
    Forgery("a larger allowance", "cleared", edit("evidence/results/5/spent/at_most", 10**6)),
    Forgery("fewer evaluations of validation", "cleared", edit("evidence/results/5/spent/stored", 5)),
    Forgery("no allowance", "cleared", lambda f: f.evidence["results"][5].pop("spent")),
    Forgery("another unit of a criterion", "cleared", edit("evidence/results/2/criteria/0/unit", "km")),
    Forgery("another identity of the code", "cleared", edit("result/identity/digest", "0" * 64)),
    Forgery("another own file", "cleared", edit("result/identity/files", {"components/a.py": "0" * 64})),
    Forgery("a claim of another name", "cleared", lambda f: f.result.update(proved="no worse case exists")),
    Forgery("another method in the table", "cleared", _table(lambda row: [*row[:2], "proof", *row[3:]], 30)),
    Forgery("a reason of what succeeded", "cleared", _table(lambda row: [*row[:-1], "proved"], 30)),
    Forgery("another header of the table", "cleared", _table(lambda row: [*row[:-1], "proof"], 0)),
    Forgery("a trajectory of no finding", "cleared", _trajectory),
    Forgery("another unit of a trajectory", "cleared", _trajectory_unit, "files.trace"),
    Forgery("an excluded row that is ok", "excluded", _excluded_that_is_ok),
    Forgery("no sensitivity stage", "cleared", _without_a_stage, "campaign.stages"),
    Forgery("an effect of a parameter", "cleared", edit(f"{ENCOUNTER}/influence/vehicle.m", 9.0), "result.encounter"),
    Forgery("findings left out", "cleared", edit("evidence/results/5/spent/left_out/findings", 7), "spent.left_out"),
    Forgery("a cost of no claim", "cleared", _cost, "arrays.costs"),
    Forgery("a horizon of the campaign", "noisy", edit("campaign/scenario/horizon", 40.0)),
    Forgery("bounds of the campaign", "noisy", edit("campaign/uncertain/vehicle.m/plus_minus", "30%")),
    Forgery("a closest approach", "cleared", edit(f"{ENCOUNTER}/closest/time", 1.0), "result.encounter.closest"),
    Forgery("an approach of which no more is known", "cleared", _approaching),
    Forgery("a distance that is not computed", "cleared", _mismeasured),
    Forgery("a fault that no flight has", "cleared", _never),
    Forgery("a fault that no flight has as a whole", "cleared", _partly),
    Forgery("code of another version", "cleared", _other_code, "result.versions"),
    Forgery("code of another version alone", "cleared", edit("result/versions/code", "0" * 64)),
    Forgery("a probability", "estimated", edit(f"{ESTIMATE_}/probability", 0.001)),
    Forgery("a lower end", "estimated", edit(f"{ESTIMATE_}/low", 1e-4)),
    Forgery("an upper end", "estimated", edit(f"{ESTIMATE_}/high", 0.0152)),
    Forgery("a sentence with another probability", "estimated", _less_likely),
    Forgery("an effective sample size", "estimated", edit(f"{ESTIMATE_}/effective", 500.0)),
    Forgery("a share", "estimated", edit(f"{ESTIMATE_}/modes/0/share", 0.5)),
    Forgery("a point of a mode", "estimated", edit(f"{ESTIMATE_}/modes/0/parameters/vehicle.m", 4.0)),
    Forgery("a mode left out", "estimated", lambda f: f.evidence["results"][ESTIMATE]["modes"].pop()),
    Forgery("draws left out", "estimated", edit(f"{ESTIMATE_}/final/first", 500)),
    Forgery("fewer draws", "estimated", edit(f"{ESTIMATE_}/final/count", 100)),
    Forgery("another independent sample", "estimated", edit(f"{ESTIMATE_}/independent/first", 45)),
    Forgery("another seed of the draws", "estimated", edit(f"{ESTIMATE_}/seed", 2)),
    Forgery("another density", "estimated", edit(f"{ESTIMATE_}/density/covariances/0/0/0", 9.0)),
    Forgery("an origin that does not violate", "estimated", edit(f"{ESTIMATE_}/modes/0/origins/0/index", 0)),
    Forgery("nothing estimated", "estimated", _nothing_estimated),
    Forgery("a coefficient of V", "attracted", _digit("v/coefficients/numbers/0")),
    Forgery("a Gram matrix of positivity", "attracted", _digit("positive/0/numbers/1")),
    Forgery("a Gram matrix of a limit", "attracted", _digit("positive/1/numbers/0")),
    Forgery("a multiplier", "attracted", _digit("multiplier/numbers/0")),
    Forgery("a Gram matrix of the decrease", "attracted", _digit("decrease/numbers/3")),
    Forgery("coordinates of a region", "attracted", _digit("coordinates/numbers/1")),
    Forgery("a finer scale of V", "attracted", _doubled("v/coefficients")),
    Forgery("a power of V", "attracted", edit(f"{ATTRACTION_}/proof/v/powers/0/0", 3)),
    Forgery("a proof left out", "attracted", lambda f: f.evidence["results"][3].pop("proof")),
    Forgery("a number that is none", "attracted", edit(f"{ATTRACTION_}/proof/multiplier/numbers/0", "many")),
    Forgery("a model of another loop", "attracted", _slower_loop),
    Forgery("a trim", "attracted", edit(f"{ATTRACTION_}/states/0/trim", 0.1)),
    Forgery("a wider limit", "attracted", edit(f"{ATTRACTION_}/states/0/limit", 6.3)),
    Forgery("no limit", "attracted", edit(f"{ATTRACTION_}/states/1/limit", None)),
    Forgery("a reference that is held", "attracted", edit(f"{ATTRACTION_}/held/0/value", 1.0)),
    Forgery("a reach", "attracted", edit(f"{ATTRACTION_}/states/0/reach", 3.1)),
    Forgery("a fraction", "attracted", edit(f"{ATTRACTION_}/fraction", 0.9)),
    Forgery("a section", "attracted", edit(f"{ATTRACTION_}/sections/0/proved/5", 2.0)),
    Forgery("another degree of V", "attracted", edit(f"{ATTRACTION_}/degree", 4)),
    Forgery("rays that contradict", "attracted", edit(f"{ATTRACTION_}/contradicting", 1)),
    Forgery("an end of a simulation in a section", "attracted", edit(f"{ATTRACTION_}/sections/0/simulated/1", 9.0),
            "results.#.sections.#.simulated"),
    Forgery("another noise seed", "noisy", _another_noise),
    Forgery("a noise seed of a counted draw", "counted noise", _another_noise),
    Forgery("no noise of its own", "noisy", _no_noise),
    Forgery("a gap above nothing", "violated", _above_nothing),
    Forgery("a seed taken out", "cleared", lambda f: f.result.pop("seed")),
    Forgery("the code of another check", "cleared", edit("result/checks/0/code", "agreement")),
    Forgery("a reason in the table", "excluded", _other_reason),
    Forgery("a failure that was none", "violated", _failure),
    Forgery("seconds of a stage", "cleared", edit("result/stages/2/seconds", 9e9), "result.stages.#.seconds"),
]  # fmt: skip


def leaves(document: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all values in a document."""
    if not isinstance(document, dict | list):
        yield path
        return
    for key, value in document.items() if isinstance(document, dict) else enumerate(document):
        yield from leaves(value, (*path, key))


def places(folder: Folder, seed: int, count: int) -> list[tuple[str, tuple[Any, ...]]]:
    """Some values of the record, of every part of it; digests and descriptions of components have their own tests."""
    found = [(part, path) for part in ("result", "evidence") for path in leaves(getattr(folder, part))]
    found = [at for at in found if at[1][0] not in ("components", "evidence_digest", "files", "digest")]
    return random.Random(seed).sample(found, min(count, len(found)))


def changed(folder: Folder, part: str, path: tuple[Any, ...]) -> str:
    """Another value at a place of the record; returns the place with # for every index."""
    stated: Any = getattr(folder, part)
    for key in path[:-1]:
        stated = stated[key]
    stated[path[-1]] = _other(stated[path[-1]])
    return ".".join([part, *("#" if isinstance(key, int) else str(key) for key in path)])


def sentences(folder: Folder) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """The paths of everything that has a sentence, one of each of those that a list repeats in the same form."""
    seen = set()
    for part in ("result", "evidence"):
        for path in leaves(getattr(folder, part)):
            for at in (path[:k] for k, name in enumerate(path) if name == "statement" and path[0] != "components"):
                kind = tuple("#" if isinstance(key, int) and k != 1 else key for k, key in enumerate(at))
                if (part, kind) not in seen:
                    seen.add((part, kind))
                    yield part, at


def bolder(folder: Folder, part: str, path: tuple[Any, ...]) -> str:
    """Bold words at the end of a sentence, in spans and text; returns the place with # for every index."""
    stated: Any = getattr(folder, part)
    for key in path:
        stated = stated[key]
    if isinstance(stated["statement"], list):
        stated["statement"].append({"kind": "text", "text": BOLD})
    if "text" in stated:
        stated["text"] += BOLD
    return ".".join([part, *("#" if isinstance(key, int) else str(key) for key in path), "statement"])


def _other(value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + 1 if isinstance(value, int) else value * 1.01 + 1e-6
    return 1.0 if value is None else value + BOLD


def accepted(folder: Folder) -> bool:
    """Whether the verdict follows from a record; one that cannot be read is rejected."""
    try:
        sealed = "files" in folder.evidence  # a record in the form of an earlier version has no digest
        if sealed:
            folder.reseal()
        return closing(folder.items(write=not sealed))[0]
    except (UnreadableError, CampaignError, ValueError):
        return False


def trusted(path: str) -> bool:
    return any(re.search(pattern, path) for one in TRUSTED for pattern in one.paths)
