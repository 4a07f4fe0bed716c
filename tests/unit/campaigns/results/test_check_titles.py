"""Every check of a verdict has a title, and no check claims to hold for evaluations without a value."""

from __future__ import annotations

from backend.reports.words import svg_symbol, symbol_html
from campaigns.asked.spec import Encounter
from campaigns.results.verdict import Check
from campaigns.results.verdicts import described, validated
from campaigns.rules import RULES, rule
from campaigns.symbols import labels, name_of
from tests.given.case_campaigns import case1
from tests.given.verdict_evidence import case, concluded, evidence
from worker.evidence.verdicts.checks import checks


def test_every_check_has_a_title() -> None:
    names = {check.name for check in checks(case1(), evidence(excluded=1))} | {"noise", "target", "probability"}
    assert all(rule(name) for name in names)
    intended = Encounter.model_json_schema()["properties"]["intended"]["propertyNames"]["enum"]
    assert {name.replace("_", " ") for name in intended} == {rule.code for rule in RULES if rule.intended}


def test_checks_of_values_are_open_where_evaluations_failed() -> None:
    stored = concluded(failed=2).checks
    told = {check.name: check for check in described(stored, 2)}
    of_values = [rule.code for rule in RULES if rule.of_values]
    assert of_values
    for name in of_values:
        assert told[name].ok
        assert told[name].standing == "open"
        assert told[name].but.startswith("2 ")
    assert told["evaluations"].standing == "fails"
    assert told["motion"].standing == "holds"
    assert {check.standing for check in described(concluded().checks, 0)} == {"holds"}


def test_a_check_of_an_earlier_version_is_titled_by_its_name() -> None:
    (told,) = described([Check(name="half step", ok=True, text="")], 0)
    assert (told.title, told.standing, told.but) == ("Half step", "holds", "")


def test_a_case_is_described_by_what_was_stored() -> None:
    cases = (None, case(agrees=None, violates=None), case(), case(agrees=False, violates=True), case(confirmed=False))
    assert [validated(one) for one in cases] == [
        "not validated", "confirmed", "integrations agree", "violation confirmed, beyond tolerance",
        "integrations disagree",
    ]  # fmt: skip


def test_a_shared_symbol_is_never_shown() -> None:
    known = {"vehicle.m": "m", "obstacles.0.x": "x", "obstacles.1.x": "x", "start.x": "x"}
    assert labels(["vehicle.m", "obstacles.1.x"], known) == {"vehicle.m": "m", "obstacles.1.x": "x of obstacle 2"}
    assert labels(["a.q", "b.q"], {}) == {"a.q": "a.q", "b.q": "b.q"}


def test_the_symbol_of_a_threshold_which_no_catalogue_has_counts_nowhere() -> None:
    known = {"vehicle.drag": "c"}
    own = {"criterion.threshold": "c", "objectives.0.threshold": "c"}
    assert labels(known, known) == labels(known, known | own) == {"vehicle.drag": "c"}
    of_others = labels(known, known | {"faults.0.threshold": "c", "simulator.threshold": "c"})
    assert of_others == {"vehicle.drag": name_of("vehicle.drag", "c")}


def test_a_parameter_without_a_symbol_is_named_by_the_last_part_of_its_path() -> None:
    assert labels(["simulator.a"], {"simulator.a": "", "simulator.b": ""}) == {"simulator.a": "a"}
    assert labels(["vehicle.m"], {"vehicle.m": "", "start.m": ""}) == {"vehicle.m": name_of("vehicle.m", "m")}


def test_a_shared_symbol_names_the_part_it_belongs_to() -> None:
    paths = ["obstacles.0.position.y", "start.y", "faults.2.y", "vehicle.y", "vehicle.b", "sim.y"]
    found = labels(paths, dict.fromkeys(paths, "y"))
    assert found["obstacles.0.position.y"] == "y of obstacle 1"
    assert found["start.y"] == "y of the start"
    assert found["faults.2.y"] == "y of fault 3"
    # Names that would not distinguish two parameters, and parts without a name: the path.
    assert [found[path] for path in paths[3:]] == ["vehicle.y", "vehicle.b", "sim.y"]
    assert len(set(found.values())) == len(paths)


def test_the_symbol_of_a_name_is_in_italics_and_its_part_is_not() -> None:
    assert symbol_html("omega_r of obstacle 1", "obstacles.0.rate") == (
        '<i class="v" title="obstacles.0.rate">ω</i><sub>r</sub> of obstacle 1'
    )
    assert symbol_html("m", "vehicle.m") == '<i class="v" title="vehicle.m">m</i>'
    assert svg_symbol("y of obstacle 1").endswith("<tspan> of obstacle 1</tspan>")
