"""Methods and budgets proposed from the time of an evaluation: they fit, they exist, and the command prints them."""

from __future__ import annotations

import itertools
import math
from functools import partial

import pytest
import yaml

from campaigns import check
from campaigns.asked import proposal
from campaigns.asked.proposal import ALONE, BUSY, LONGEST, RETRIED, WAITING, Cost, lasting, taking
from campaigns.rules import GLOBAL_LEAST
from clearance.cli import WRONG_INPUT, invoke
from tests.given.case_campaigns import searching
from worker.engine.search.methods import auto
from worker.running.catalogue.installed import catalogue, methods

METHODS = catalogue().methods
TITLES = {method.name: method.title for method in METHODS}
proposed = partial(proposal.proposed, METHODS)
GRID = list(itertools.product([1e-6, 1e-3, 0.03, 1.0, 12.0, 900.0], [1, 4, 25], [1, 4, 300], [0.5, 10.0, 1200.0, 1e6]))


def test_a_simulator_of_twelve_seconds() -> None:
    found = proposed(12.0, 4, slots=4, patience=1200.0)
    assert [(s.method, s.evaluations, s.options) for s in found.searches] == [
        ("auto", 400, {"at_once": 4, "seconds": 12.0})
    ]
    assert found.seconds == 1200.0


@pytest.mark.by_day(50)
@pytest.mark.parametrize(("cost", "parameters", "slots", "patience"), GRID)
def test_whatever_is_proposed_fits_and_can_be_run(cost: float, parameters: int, slots: int, patience: float) -> None:
    found = proposed(cost, parameters, slots, patience)
    assert bool(found.searches) == (cost <= patience)
    assert found.seconds <= patience * (1 + 1e-9)
    busy = min(slots, BUSY)
    assert found.seconds == pytest.approx(sum(math.ceil(s.evaluations / busy) * cost for s in found.searches))
    assert f"about {lasting(cost)}" in found.sentence
    for search in found.searches:
        assert search.evaluations >= 1
        assert ("seconds" in search.options) == (cost >= 0.02)
    if found.searches:
        stages = [{"method": s.method, "evaluations": s.evaluations, "options": s.options} for s in found.searches]
        assert check(searching(*stages), catalogue()) == []


@pytest.mark.parametrize("start", [0.3, 5.0, 1e3])
def test_the_start_of_the_processes_is_part_of_the_time(start: float) -> None:
    for cost, parameters, slots, patience in GRID:
        found = proposed(cost, parameters, slots, patience, start)
        assert bool(found.searches) == (start + cost <= patience)
        if found.searches:
            rounds = sum(math.ceil(s.evaluations / min(slots, BUSY)) for s in found.searches)
            assert found.seconds == pytest.approx(start + rounds * cost)
            assert found.seconds <= patience * (1 + 1e-9)
        elif start > cost:
            assert all(f" {lasting(seconds)}" in found.sentence for seconds in (cost, start, patience))


@pytest.mark.parametrize(
    ("calls", "recycle", "each", "fresh"),
    [(1, 0, 2.0, 5.0), (1, 1, 5.0, 5.0), (1, 3, 3.0, 5.0), (2, 3, 3.0, 5.0), (5, 3, 6.0, 10.0)],
)
def test_processes_that_are_replaced_or_fresh_take_their_start(
    calls: int, recycle: int, each: float, fresh: float
) -> None:
    """On four slots: five calls of an evaluation take two turns."""
    cost = Cost("R-0001", 2.0, 4, 15, start=3.0, recycle=recycle)
    at_once = cost.of(calls)[1]
    assert cost.of(calls) == (pytest.approx(each), {1: 4, 2: 2, 5: 1}[calls])
    assert cost.again(at_once, calls) == pytest.approx(fresh)
    seconds, known = cost.lasts(10 * at_once, calls, again=2 * at_once)
    assert seconds == pytest.approx(3.0 + 10 * each + 2 * fresh)
    assert known.startswith(cost.sentence(calls))
    assert f"; {2 * at_once} more{cost.fresh} " in known


def test_what_is_proposed_has_what_two_parts_need_to_confirm_each_other_or_says_so() -> None:
    for cost, parameters, slots, patience in GRID:
        found = proposed(cost, parameters, slots, patience)
        enough = all(s.evaluations >= methods()[s.method].confirms * parameters for s in found.searches)
        assert enough != bool(found.note)


def test_the_witness_has_enough_evaluations_to_count_as_a_search() -> None:
    assert auto.method.confirms >= GLOBAL_LEAST.value / min(auto.WITNESS.values())


@pytest.mark.parametrize("slots", [1, WAITING, WAITING + 1, BUSY, BUSY + 1, 64, 256])
def test_the_time_on_slots_that_wait_is_a_lower_bound_wherever_it_is_stated(slots: int) -> None:
    """Searches by `auto` took 1.2 to 1.9 times as long on 16 slots, and on more no less than half of what 16 take."""
    lower = WAITING < slots <= BUSY
    for patience in (60.0, 6000.0):
        for found in (proposed(1.0, 4, slots, patience), Cost("R-0001", 1.0, slots, 15).proposed(METHODS, 4, patience)):
            (search,) = found.searches
            assert search.evaluations <= patience * min(slots, BUSY)
            time = taking(found.seconds, slots)
            assert time.startswith("at least ") == lower
            assert time in found.sentence
            stated = found.note.rpartition("(")[2].partition(")")[0]
            assert not found.note or stated == taking(math.ceil(500 / min(slots, BUSY)), slots)
            assert (f"counted as {BUSY}" in found.sentence) == (slots > BUSY)


@pytest.mark.parametrize("slots", [1, WAITING, WAITING + 1, 8, BUSY, BUSY + 1, 64, 256])
@pytest.mark.parametrize("calls", [1, 3])
def test_the_time_of_what_is_proposed_is_the_same_once_it_is_a_campaign(slots: int, calls: int) -> None:
    """With what confirms it."""
    cost = Cost("R-0001", 1.0, slots, 15, start=0.5)
    found = cost.proposed(METHODS, 4, 300.0, calls)
    (search,) = found.searches
    seconds, statement = cost.lasts(search.evaluations, calls)
    assert seconds == pytest.approx(found.seconds)
    assert (f"counted as {BUSY}" in statement) == (cost.of(calls)[1] > BUSY)
    assert cost.again(BUSY * 10, calls) >= 10 * (cost.seconds + cost.start)


@pytest.mark.parametrize("slots", [1, WAITING + 1, BUSY, 64])
@pytest.mark.parametrize("calls", [1, 3])
@pytest.mark.parametrize("recycle", [0, 3])
def test_between_its_bounds_is_whatever_number_of_slots_a_search_keeps_busy(
    slots: int, calls: int, recycle: int
) -> None:
    """From one point at a time, which `nlopt_global` and `turbo` may request, to all slots."""
    cost = Cost("R-0001", 1.0, slots, 15, start=0.5, recycle=recycle)
    each, at_once = cost.of(calls)
    least, most = cost.bounds(1000, 1000, calls)
    for used in range(1, at_once + 1):
        assert least <= cost.start + math.ceil(1000 / used) * each <= most
    assert least <= cost.lasts(1000, calls)[0] <= most
    assert 1000 * (cost.seconds + cost.start) <= most


@pytest.mark.parametrize(("slots", "calls"), [(1, 1), (1, 3), (4, 1), (4, 3)])
@pytest.mark.parametrize("retries", [1, 10])
def test_the_longest_time_counts_every_retry_and_the_usual_one_none(slots: int, calls: int, retries: int) -> None:
    cost = Cost("R-0001", 1.0, slots, 15, start=0.5)
    (least, most), (least_once, most_once) = cost.bounds(50, 100, calls, retries), cost.bounds(50, 100, calls)
    assert most - cost.start == pytest.approx((1 + retries) * (most_once - cost.start))
    assert least == least_once
    seconds, statement = cost.lasts(100, calls, retries=retries)
    assert seconds == cost.lasts(100, calls)[0]
    ways = [ALONE, RETRIED] if cost.of(calls)[1] > 1 else [RETRIED]
    assert statement == f"{cost.lasts(100, calls)[1].partition('. ')[0].rstrip('.')}. {LONGEST.format(', '.join(ways))}"


def test_the_slots_that_count_are_those_that_auto_keeps_busy() -> None:
    assert BUSY == auto.PENDING


def test_where_too_few_fit_the_sentence_names_how_many_are_needed_and_their_time() -> None:
    found = proposed(60.0, 5, patience=1800.0)
    assert [(s.method, s.evaluations) for s in found.searches] == [("auto", 30)]
    assert "10 h" in found.note
    assert not proposed(60.0, 5, patience=10.5 * 3600).note
    assert not proposed(7200.0, 5, patience=600.0).searches


def test_every_outcome_has_its_sentence() -> None:
    """Enough, too few with what is missing, none, and none because processes start slowly; where the time is from."""
    cost = Cost("R-0001", 2.0, 4, 15, start=3.0, recycle=3)
    assert [
        *(found.sentence for found in (
            proposed(12.0, 4, slots=4, patience=1200.0), proposed(60.0, 5, patience=1800.0),
            proposed(7200.0, 5, patience=600.0), proposed(10.0, 5, patience=600.0, start=900.0),
            proposed(12.0, 4, slots=16, patience=120.0), proposed(12.0, 4, slots=64, patience=600.0),
        )),
        cost.lasts(20, 5, again=2)[1], Cost("R-0001", 2.0, 1, 15, failed=3).lasts(20)[1],
        *(Cost("R-0001", 2.0, k, 15).lasts(20)[1] for k in (8, 40)),
        *(of.proposed(METHODS, 4, 600.0).sentence for of in (cost, *(Cost("R-0001", 2.0, k, 15) for k in (8, 40)))),
    ] == [
        "One evaluation takes about 12 s: 400 evaluations take about 20 min on 4 slots; use Auto; it may be "
        "too few for a verdict of cleared: below 500 evaluations (about 25 min) its parts need not count as searches",
        "One evaluation takes about 60 s: 30 evaluations take about 30 min; use Auto; it may be too few for a "
        "verdict of cleared: below 625 evaluations (about 10 h) its parts need not count as searches",
        "One evaluation takes about 2 h, longer than the 10 min that are available: allow more time",
        "One evaluation takes about 10 s and the start of its process 15 min, longer than the 10 min that are "
        "available: allow more time",
        "One evaluation takes about 12 s: 160 evaluations take at least 2 min on 16 slots; use Auto; it may be too few "
        "for a verdict of cleared: below 500 evaluations (at least 6.4 min) its parts need not count as searches",
        "One evaluation takes about 12 s: 800 evaluations take about 10 min on 64 slots (counted as 16 evaluations "
        "side by side); use Auto",
        "One call took 2 s (R-0001, 15 evaluations) and the start of a process 3 s; an evaluation of 5 calls takes "
        "about 6 s, on 4 slots; 2 more, each in a fresh process, confirm results.",
        "One evaluation took 2 s (R-0001, 15 evaluations, of which 3 failed), on 1 slot.",
        "One evaluation took 2 s (R-0001, 15 evaluations), on 8 slots. The time with all "
        "evaluations is that of one evaluation after the other.",
        "One evaluation took 2 s (R-0001, 15 evaluations), on 40 slots (counted as 16 evaluations side by side). The "
        "time with all evaluations is that of one evaluation after the other.",
        "In 10 min on 4 slots: about 800 evaluations. Proposed: Auto with 796, about 10 min in all",
        "In 10 min on 8 slots: at most about 2,400 evaluations. Proposed: Auto with 2,400, at least 10 min in all",
        "In 10 min on 40 slots (counted as 16 evaluations side by side): about 4,800 evaluations. Proposed: Auto with "
        "4,800, about 10 min in all",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("given", "names"),
    [((0.0, 3), "cost 0"), ((float("nan"), 3), "cost nan"), ((float("inf"), 3), "cost inf"), ((-1.0, 3), "cost -1"),
     ((1.0, 3, 1, 9.0, -1.0), "start -1"), ((1.0, 3, 1, 9.0, float("nan")), "start nan"),
     ((1.0, 0), "parameters 0"), ((1.0, 3, 0), "slots 0"), ((1.0, 3, 1, 0.0), "patience 0")],
)  # fmt: skip
def test_impossible_values_are_refused(given: tuple[float, int], names: str) -> None:
    with pytest.raises(ValueError, match=names):
        proposed(*given)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(2e-5, "20 µs"), (0.0123, "12 ms"), (12.0, "12 s"), (99.9, "100 s"), (1200.0, "20 min"), (5000.0, "83 min"),
     (9000.0, "2.5 h"), (1e6, "12 days"), (1e9, "12,000 days")],
)  # fmt: skip
def test_a_length_of_time_has_a_unit_that_fits(seconds: float, text: str) -> None:
    assert lasting(seconds) == text


def test_the_command_prints_stages_of_a_campaign(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["propose", "--cost", "12", "--parameters", "4", "--slots", "4", "--patience", "1200"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith(f"# {proposed(12.0, 4, slots=4, patience=1200.0).sentence}")
    stages = yaml.safe_load(shown)["stages"]["search"]
    assert stages == [{"method": "auto", "evaluations": 400, "options": {"at_once": 4, "seconds": 12.0}}]
    assert check(searching(*stages), catalogue()) == []


@pytest.mark.parametrize(
    ("arguments", "statement"),
    [(["--cost", "0", "--parameters", "3"], "invalid cost 0"), (["--cost", "9999", "--parameters", "3"], "allow more")],
)
def test_the_command_refuses_what_cannot_be(
    arguments: list[str], statement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["propose", *arguments]) == WRONG_INPUT
    assert statement in capsys.readouterr().err


@pytest.mark.parametrize(
    ("slots", "calls", "expected"),
    [(1, 1, (2.0, 1)), (4, 1, (2.0, 4)), (4, 2, (2.0, 2)), (4, 3, (2.0, 1)), (4, 5, (4.0, 1)), (2, 5, (6.0, 1))],
)
def test_calls_of_an_evaluation_go_through_the_slots_in_turns(
    slots: int, calls: int, expected: tuple[float, int]
) -> None:
    assert Cost("R-0001", 2.0, slots, 15).of(calls) == expected


def test_what_a_measured_cost_proposes_is_what_the_command_proposes() -> None:
    for cost, parameters, slots, patience in GRID:
        found = Cost("R-0001", cost, slots, 15).proposed(METHODS, parameters, patience)
        same = proposed(cost, parameters, slots, patience)
        assert (found.searches, found.seconds, found.note) == (same.searches, same.seconds, same.note)
        if found.searches:
            assert found.sentence.startswith(f"In {lasting(patience)} on {slots} slot")
            assert f"{found.searches[0].evaluations:,}" in found.sentence
            assert all(TITLES[s.method] in found.sentence for s in found.searches)
            assert found.sentence.endswith(found.note)


def test_no_call_is_no_evaluation() -> None:
    with pytest.raises(ValueError, match="calls 0"):
        Cost("R-0001", 2.0, 1, 15).proposed(METHODS, 2, 60.0, calls=0)
