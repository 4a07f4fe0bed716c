"""Agreement, judged a second time: where there is nothing to agree on, within rounding, and of earlier versions."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from worker.evidence.audit import limits
from worker.evidence.audit.agreement import agreement
from worker.evidence.audit.parts import Counts


def run(first: float, second: float, nominal: float, varies: bool = True, older: bool = False, **more: Any) -> Any:
    """What `agreement` reads of a run in which two global methods of different families searched."""
    methods = {
        k: SimpleNamespace(name=name, kind="global", family=name, families={}, apart={}, options={})
        for k, name in enumerate(("direct", "genetic"))
    }
    finding = {"label": "F1", "cost": min(first, second), "validation": {"realisation": None}}
    search = [SimpleNamespace(options={}, starts=more.get("starts", [])) for _ in methods]
    return SimpleNamespace(
        claims={
            "findings": [finding], "comparison": [{"basin": "F1"}, {"basin": "F1"}], "results": [{}, {}],
            "verdict": "inconclusive",
        },
        campaign=SimpleNamespace(agreement=0.05, stages=SimpleNamespace(search=search)),
        nominal=nominal, threshold=0.0, searches=[0, 1], methods=methods, bounds={"a": (0.0, 1.0)},
        ended=[Counts(100, 0, 0)] * 2, plan=[SimpleNamespace(planned=1000)] * 2, best=[first, second],
        installed={m.name: m for m in methods.values()}, varies=varies, older=older, wording=more.get("wording", 9),
        known={"a": ("", 0.5)},
        findings=[SimpleNamespace(label="F1", parameters={"a": 0.1})],
    )  # fmt: skip


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e9])
def test_what_one_method_missed_is_no_rounding_on_any_scale(scale: float) -> None:
    assert agreement(run(0.43 * scale, 0.43 * scale, 1.4 * scale))
    assert not agreement(run(0.43 * scale, 1.0 * scale, 1.4 * scale))


def test_nothing_agrees_where_the_nominal_case_failed() -> None:
    assert not agreement(run(1.0, 1.0, math.nan, varies=False))


def test_a_flat_criterion_agrees_but_of_earlier_versions_only_within_their_rule() -> None:
    flat = (100.0, 100.00004, 100.00004)
    assert agreement(run(*flat, varies=False))
    assert not agreement(run(*flat, varies=False, older=True))
    assert agreement(run(100.0, 100.0 + 1e-8, 100.00004, varies=False, older=True))


def test_a_difference_of_rounding_is_compared_as_the_verdict_compares_it() -> None:
    best = 1.0 + 5 * math.ulp(1.0)
    assert not agreement(run(1.0, best, 1.0 + 1e-14))


def test_searches_that_started_at_the_worst_case_do_not_confirm_it_but_in_earlier_versions() -> None:
    assert agreement(run(0.43, 0.43, 1.4, starts=[{"a": 0.2}, {}]))
    assert not agreement(run(0.43, 0.43, 1.4, starts=[{"a": 0.2}, {"a": 0.12}]))
    assert agreement(run(0.43, 0.43, 1.4, starts=[{"a": 0.12}], wording=8))


@pytest.mark.parametrize("parts", [False, True])
def test_searches_of_one_method_whose_members_share_confirm_each_other_only_in_earlier_versions(parts: bool) -> None:
    def judged(**more: Any) -> bool:
        made = run(0.43, 0.43, 1.4, **more)
        for k, family in enumerate(("gradients", "division")):
            alone = {"member": "racing", "family": "racing", "evaluations": 50, "best": more.get("alone", 1.0)}
            led = {"member": family, "family": family, "evaluations": 50, "best": 0.43}
            made.methods[k].name, made.methods[k].family = "auto", family
            made.methods[k].apart = {"racing": "racing"} if parts else {}
            members = [{"member": family, "apart": False}, {"member": "racing", "apart": parts}]
            made.claims["results"][k] = {"members": members, "family": family} | (
                {"apart": [led, alone]} if parts else {}
            )
            made.claims["comparison"][k] = {"basin": "F1", "apart": ["F1", "F1"] if parts else []}
        return agreement(made)

    assert not judged(wording=10)
    assert judged(wording=9)
    assert judged(wording=10, alone=0.43) is parts


@pytest.mark.parametrize(("wording", "agree"), [(limits.ALIKE, False), (limits.ALIKE - 1, True)])
@pytest.mark.parametrize("stated", ["population", ""], ids=["stated", "forged"])
def test_a_search_by_the_principle_of_a_member_that_shares_confirms_nothing_but_in_earlier_versions(
    wording: int, agree: bool, stated: str
) -> None:
    made = run(0.43, 0.43, 1.4, wording=wording)
    made.installed["evolving"] = SimpleNamespace(name="evolving", family="population", families={}, options={})
    made.methods[1].family = "population"
    rows = [{"member": "sqp", "family": "gradients"}, {"member": "evolving", "family": stated}]
    made.claims["results"][0] = {"members": rows, "family": "gradients"}
    assert agreement(made) is agree
