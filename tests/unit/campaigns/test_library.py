"""`import clearance`: what a search refuses, what a function may do wrong, and what a result contains."""

from __future__ import annotations

import builtins
import dataclasses
import os
import pickle
import re
import signal
import sys
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clearance
from campaigns.claims import numbers
from campaigns.results.base import FLAKY, STATUS
from tests.simulators import isolated
from worker.engine.systems.simulators import calling
from worker.engine.systems.simulators.declared.excluded import Excluded
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.functions import InProcess
from worker.running.catalogue.files import entry_of

Parameter = clearance.Parameter
RANGES = {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}
SMALL: dict[str, Any] = {"methods": {"direct": 40, "cma_es": 60}, "certify": 10}


def bowl(mass: float, drag: float) -> float:
    return 60.0 - 8.0 * (mass - 1.5) ** 2 - 100.0 * (drag - 0.13) ** 2


def one(mass: float) -> float:
    return mass


def edgy(mass: float, drag: float) -> float:
    if mass > 2.2:
        raise ValueError("too <b>heavy</b>")
    return 60.0 - mass * drag


class TestArguments:
    @pytest.mark.parametrize(
        ("change", "kind", "message"),
        [
            ({"parameters": {"mass": (2.3, 1.5), "drag": (0, 1)}}, ValueError, "mass: low 2.3 must be below high 1.5"),
            ({"parameters": {"mass": (1.0, 1.0), "drag": (0, 1)}}, ValueError, "mass: low 1 must be below high 1"),
            ({"parameters": {"mass": 1.5, "drag": (0, 1)}}, TypeError, r"mass: give a range \(low, high\), given 1.5"),
            ({"parameters": {"mass": ("a", 2), "drag": (0, 1)}}, ValueError, "must be finite numbers, .* given 'a'"),
            ({"parameters": {"mass": (0, float("inf")), "drag": (0, 1)}}, ValueError, "must be finite numbers"),
            ({"parameters": {"mass": (True, 2), "drag": (0, 1)}}, ValueError, "must be finite numbers"),
            ({"parameters": {}}, TypeError, "parameters must be a dict"),
            ({"parameters": None}, TypeError, "parameters must be a dict"),
            ({"parameters": [("mass", (1, 2))]}, TypeError, "parameters must be a dict"),
            ({"parameters": {"mas": (1, 2), "drag": (0, 1)}}, TypeError, r"called as bowl\(mas=..., drag=...\)"),
            ({"parameters": {"mass": (1, 2)}}, TypeError, "missing a required .*'drag'"),
            ({"parameters": {"m\u00e4ss": (1, 2)}}, ValueError, "invalid name 'm\u00e4ss'"),
            ({"parameters": {1: (1, 2)}}, ValueError, "invalid name 1"),
            ({"threshold": None}, ValueError, "threshold must be a finite number"),
            ({"threshold": float("nan")}, ValueError, "threshold must be a finite number"),
            ({"threshold": "50"}, ValueError, "threshold must be a finite number"),
            ({"nominal": {"mas": 2.0}}, ValueError, "nominal: there is no parameter 'mas'; there is mass, drag"),
            ({"nominal": {"mass": 9.0}}, ValueError, "nominal: mass must be a number within 1.5 to 2.3, given 9.0"),
            ({"methods": ["directt"]}, ValueError, "did you mean 'direct'"),
            ({"methods": []}, TypeError, "methods must be names"),
            ({"methods": ["direct", "direct"]}, ValueError, "the same method is given twice"),
            ({"methods": {"direct": 0}}, ValueError, "evaluations of direct must be a whole number above 0"),
            ({"budget": 0}, ValueError, "budget must be a whole number of at least 1"),
            ({"budget": 10.5}, ValueError, "budget must be a whole number"),
            ({"certify": -1}, ValueError, "certify must be a whole number of at least 0"),
            ({"seed": 1.5}, ValueError, "seed must be a whole number"),
            ({"worse": "high"}, ValueError, "return the margin, such as limit - value, and give threshold=0"),
            ({"unit": "m\n"}, ValueError, "unit must be one line of text"),
            ({"name": "x" * 300}, ValueError, "name must be one line of text"),
            ({"result": "separation"}, ValueError, "only a function decorated"),
        ],
    )  # fmt: skip
    def test_what_cannot_be_used_is_refused_before_anything_is_evaluated(
        self, change: dict[str, Any], kind: type[Exception], message: str
    ) -> None:
        called = []

        def fly(mass: float, drag: float) -> float:
            called.append(mass)
            return 1.0

        fly.__name__ = "bowl"
        given = {"parameters": RANGES, "threshold": 50.0} | change
        with pytest.raises(kind, match=message) as refused:
            clearance.search(fly, **given)
        assert called == []
        assert "\n" not in str(refused.value)

    @pytest.mark.parametrize("fly", [None, 3, "bowl"])
    def test_only_a_function_can_be_searched(self, fly: Any) -> None:
        with pytest.raises(TypeError, match="the first argument must be a function"):
            clearance.search(fly, RANGES, 50.0)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"parameters": {"z": (0, 1)}}, "alone has no parameter 'z'; it has x, y"),
            ({"parameters": {"x": (0, 5)}}, "x: range 0 to 5 must be within -1 to 2"),
            ({"parameters": {"x": (0, 0.2)}}, "x: nominal value 0.5 must be within the range 0 to 0.2"),
            ({"result": "effort"}, "effort of alone cannot decide"),
            ({"unit": "m"}, "unit: a decorated function declares this itself"),
        ],
    )
    def test_what_does_not_fit_a_declaration_is_refused(self, change: dict[str, Any], message: str) -> None:
        with pytest.raises(ValueError, match=message):
            clearance.search(isolated.alone, **({"threshold": 1.0} | change))

    def test_an_isolated_function_must_be_where_another_process_finds_it(self) -> None:
        @clearance.simulator(parameters={"x": (0, 1)})
        def local(x: float) -> float:
            return x

        with pytest.raises(ValueError, match="isolated=False"):
            clearance.search(local, threshold=0.0)


class TestDeclaration:
    @pytest.mark.parametrize(
        ("given", "kind", "message"),
        [
            ({"parameters": {"mass": Parameter(3, 2, unit="kg")}}, ValueError, r"low 3 must be below high 2 \[kg\]"),
            ({"parameters": {"mass": Parameter(1.0, 2.0, nominal=5.0)}}, ValueError, "nominal 5 must be within"),
            ({"parameters": {"mass": Parameter(float("nan"), 2.0)}}, ValueError, "low must be a finite number"),
            ({"parameters": {"mass": 3.0}}, TypeError, r"must be a Parameter or a pair"),
            ({"parameters": {"drag": (0, 1)}}, TypeError, "cannot be called as one"),
            ({"parameters": {}}, TypeError, "parameters must be a dict"),
            ({"results": {"Gap": clearance.Output()}}, ValueError, "results: invalid name 'Gap'"),
            ({"results": {"gap": "m"}}, TypeError, "results: gap must be an Output"),
            ({"results": {"gap": clearance.Output(worse="low ")}}, ValueError, "worse must be 'low' or 'high'"),
            ({"timeout": 0}, ValueError, "timeout must be above 0 s"),
            ({"slots": -1}, ValueError, "slots must be a whole number from 0 to 256"),
            ({"name": "My Sim"}, ValueError, "invalid name 'My Sim'"),
        ],
    )  # fmt: skip
    def test_what_cannot_be_used_is_refused(self, given: Any, kind: type[Exception], message: str) -> None:
        with pytest.raises(kind, match=message):
            clearance.simulator(**({"parameters": {"mass": (1.0, 2.0)}} | given))(one)

    def test_the_function_stays_a_function(self) -> None:
        declared = clearance.simulator(parameters={"mass": (1.0, 2.0)})(one)
        assert declared(3.0) == declared(mass=3.0) == 3.0
        assert (declared.__name__, declared.__doc__) == (one.__name__, one.__doc__)
        assert pickle.loads(pickle.dumps(isolated.alone)) is isolated.alone


class Odd:
    def __float__(self) -> float:
        raise RuntimeError("no")


class Speechless(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no")


def raising(error: BaseException) -> Callable[[], Any]:
    def act() -> Any:
        raise error

    return act


FAILURES: list[tuple[str, Callable[[], Any], str]] = [
    ("raises", lambda: 1 / 0, "ZeroDivisionError: division by zero, at line"),
    ("raises text", raising(ValueError("two\nlines\x00")), "ValueError: two lines?"),
    ("raises without text", raising(ValueError()), "ValueError, at line"),
    ("raises what cannot be shown", raising(Speechless()), "Speechless: its message cannot be shown"),
    ("runs out of memory", raising(MemoryError()), "MemoryError"),
    ("recurses", lambda: (f := lambda n: f(n + 1))(0), "RecursionError"),
    ("raises what few catch", raising(BaseException("stop")), "BaseException: stop, at line"),
    ("exits", lambda: sys.exit(3), "it called sys.exit(3)"),
    ("NaN", lambda: float("nan"), "it returned nan, not a finite number"),
    ("infinite", lambda: -np.inf, "it returned -inf, not a finite number"),
    ("too large", lambda: 10**400, "it returned inf, not a finite number"),
    ("nothing", lambda: None, "it returned None; is a return statement missing?"),
    ("text", lambda: "50", "it returned '50', not a number"),
    ("a boolean", lambda: True, "it returned True, not a number"),
    ("a numpy boolean", lambda: np.True_, "it returned a bool, not a number"),
    ("complex", lambda: 1j, "it returned a complex, not a number"),
    ("an array", lambda: np.ones(3), "it returned an array of shape (3,); one number is expected"),
    ("an array of one", lambda: np.ones(1), "it returned an array of shape (1,); one number is expected"),
    ("a list", lambda: [1.0], "it returned a list, not a number"),
    ("a dict", lambda: {"d": 1.0}, "its results lack value; it returned d"),
    ("an odd thing", Odd, "it returned an Odd, not a number (RuntimeError)"),
    ("a generator", lambda: (k for k in (1,)), "it returned a generator, not a number"),
    ("masked", lambda: np.ma.masked, "not"),
]  # fmt: skip


def in_process(fly: Callable[[Any], Any]) -> InProcess:
    """A vectorized function of x as a system."""
    declared = clearance.simulator(parameters={"x": (0.0, 1.0)}, name="fly", isolated=False, vectorized=True)(fly)
    entry = entry_of(declared.declaration)
    return InProcess(fly, entry, Opening({"simulator.x": 0.5}, "value"), declared.declaration)


class TestFailures:
    @pytest.mark.parametrize(("act", "reason"), [row[1:] for row in FAILURES], ids=[row[0] for row in FAILURES])
    def test_it_costs_one_evaluation(self, act: Callable[[], Any], reason: str) -> None:
        answer = calling.called(lambda x: act() if x else 1.5, {"x": 1.0}, ["value"])
        assert list(answer) == ["failed"]
        assert reason in answer["failed"]
        assert "\n" not in answer["failed"]
        assert calling.called(lambda x: act() if x else 1.5, {"x": 0.0}, ["value"]) == {"results": {"value": 1.5}}

    @pytest.mark.parametrize("value", [1.5, np.float32(1.5), np.array(1.5), Fraction(3, 2), Decimal("1.5")])
    def test_a_number_is_a_number(self, value: Any) -> None:
        found = calling.called(lambda x: value, {"x": 1.0}, ["value"])["results"]["value"]
        assert found == 1.5
        assert type(found) is float

    @pytest.mark.parametrize(
        ("fly", "status", "reason"),
        [
            (lambda x: 1.0 / x, "ok", ""),
            (lambda x: np.where(x > 0.5, np.nan, x), "failed", "it returned nan, not a finite number"),
            (lambda x: float(x.sum()), "failed", "it returned an array of shape (); given arrays of shape"),
            (lambda x: x[:, None], "failed", "it returned an array of shape"),
            (lambda x: None, "failed", "it returned None; an array of shape"),
            (lambda x: "x", "failed", "it returned 'x'; an array of shape"),
            (lambda x: x.astype(str), "failed", "not of numbers"),
            (lambda x: x > 0, "failed", "it returned an array of bool, not of numbers"),
            (lambda x: [None] * len(x), "failed", "it returned None"),
            (lambda x: x.fill(1.0) or 1.0 / x, "ok", ""),
        ],
    )
    def test_a_vectorized_function_returns_an_array_or_fails(
        self, fly: Callable[[Any], Any], status: str, reason: str
    ) -> None:
        given = np.array([[0.2], [0.9], [1.0]])
        batch, reasons = in_process(fly).evaluate(given)
        assert STATUS[batch.status[1]] == status
        assert reason in reasons.get(1, "")
        assert np.isfinite(batch.costs[1, 0]) == (status == "ok")
        assert given[:, 0].tolist() == [0.2, 0.9, 1.0]  # whatever it does to its arguments

    @pytest.mark.parametrize(
        ("raised", "of_rows", "status", "tried_again"),
        [
            (ValueError("diverged"), [None, None, None], "ok ok ok", [0, 1, 2]),
            (Excluded("far"), [None, None, None], "ok ok ok", [0, 1, 2]),
            (ValueError("diverged"), [None, ValueError("bad"), None], "ok failed ok", []),
            (Excluded("far"), [None, Excluded("far"), None], "ok excluded ok", []),
            (Excluded("far"), [None, ValueError("bad"), None], "ok failed ok", []),
            (ValueError("diverged"), [None, Excluded("far"), None], "ok failed ok", [0, 2]),
            (ValueError("diverged"), [Excluded("far")] * 3, "failed failed failed", []),
        ],
    )
    def test_a_batch_that_raises_though_none_of_its_rows_does_is_marked_as_tried_again(
        self, raised: Exception, of_rows: list[Exception | None], status: str, tried_again: list[int]
    ) -> None:
        def fly(x: Any) -> Any:
            error = raised if len(x) > 1 else of_rows[int(x[0])]
            if error is not None:
                raise error
            return 1.0 + x

        batch, reasons = in_process(fly).evaluate(np.arange(3.0)[:, None])
        assert [STATUS[code] for code in batch.status] == status.split()
        marked = [k for k, why in reasons.items() if why.startswith(FLAKY)]
        assert marked == tried_again
        assert all(str(raised) in reasons[k] for k in marked)
        assert np.isfinite(batch.costs[:, 0]).tolist() == [one == "ok" for one in status.split()]

    def test_a_batch_that_raises_fails_only_where_it_raises(self) -> None:
        def fly(x: Any) -> Any:
            if (x > 0.5).any():
                raise ValueError("too far")
            return x

        given = np.random.default_rng(1).random((20, 1))
        batch, reasons = in_process(fly).evaluate(given)
        far = given[:, 0] > 0.5
        assert np.isfinite(batch.costs[:, 0]).tolist() == (~far).tolist()
        assert sorted(reasons) == np.flatnonzero(far).tolist()
        assert all(why.startswith("ValueError: too far, ") for why in reasons.values())


@pytest.fixture(scope="module")
def result() -> clearance.Result:
    return clearance.search(edgy, RANGES, threshold=59.5, unit="m", quantity="d_min", **SMALL)


class TestResult:
    def test_every_evaluation_is_there(self, result: clearance.Result) -> None:
        m = len(result.costs)
        assert result.points.shape == (m, 2)
        assert result.names == ("mass", "drag")
        assert {len(a) for a in (result.status, result.stage, result.method)} == {m}
        heavy = result.points[:, 0] > 2.2
        assert ((result.status == "failed") == heavy).all()
        assert set(result.reasons) == set(np.flatnonzero(heavy).tolist())
        assert np.isnan(result.costs[heavy]).all()
        assert result.costs[~heavy] == pytest.approx(60.0 - result.points[~heavy].prod(1), abs=0)
        assert {"nominal", "sensitivity", "search", "certify", "validate"} == set(result.stage.tolist())
        assert set(result.method.tolist()) == {"", "direct", "cma_es"}

    def test_failed_evaluations_bar_cleared_and_are_named(self, result: clearance.Result) -> None:
        assert result.verdict == "inconclusive"
        held = {check.title: check.standing for check in result.verdict.checks}
        assert held["Failed evaluations"] == "fails"
        assert "ValueError: too <b>heavy</b>, at line" in str(result)
        assert f"{numbers.count(len(result.reasons))} evaluations failed" in str(result)

    def test_numbers_are_those_of_the_function(self, result: clearance.Result) -> None:
        assert result.worst is result.findings[0]
        for finding in result.findings:
            assert finding.cost == edgy(**finding.parameters)
            assert finding.margin == finding.cost - 59.5
        assert result.nominal.parameters == {"mass": 1.9, "drag": pytest.approx(0.15)}
        assert result.nominal.cost == edgy(**result.nominal.parameters)

    def test_it_cannot_be_changed(self, result: clearance.Result) -> None:
        with pytest.raises(dataclasses.FrozenInstanceError):
            result.threshold = 0.0  # type: ignore[misc]
        with pytest.raises(ValueError, match="read-only"):
            result.costs[0] = 0.0

    def test_a_verdict_is_a_string_with_its_reasons(self, result: clearance.Result) -> None:
        copied = pickle.loads(pickle.dumps(result.verdict))
        assert copied == "inconclusive"
        assert copied.sentence == result.verdict.sentence.strip() != ""
        assert copied.checks == result.verdict.checks

    def test_the_page_is_escaped_and_has_no_script(self, result: clearance.Result) -> None:
        page = result._repr_html_()
        assert "too &lt;b&gt;heavy" in page
        assert "<b>heavy" not in page
        assert not re.search(r"<script|\bon\w+=|javascript:|https?://", page)
        assert "<svg" in page
        assert "lowest d_min [m]" in page
        assert len(page) < 40_000

    def test_the_same_seed_gives_the_same_numbers(self, result: clearance.Result) -> None:
        seeds = {"sample_seed": result.sample_seed}
        again = clearance.search(edgy, RANGES, threshold=59.5, unit="m", quantity="d_min", **seeds, **SMALL)
        assert again.costs.tobytes() == result.costs.tobytes()
        assert again.verdict.sentence == result.verdict.sentence
        assert again.verdict.scope == result.verdict.scope

    def test_pandas_is_named_where_it_is_missing(
        self, result: clearance.Result, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setitem(sys.modules, "pandas", None)
        with pytest.raises(ImportError, match="pip install pandas"):
            result.to_dataframe()

    def test_a_column_whose_name_is_taken_gets_another(self, monkeypatch: pytest.MonkeyPatch) -> None:
        taken = clearance.search(lambda cost: cost, {"cost": (0.0, 1.0)}, -1.0, **SMALL)
        monkeypatch.setitem(sys.modules, "pandas", type("pandas", (), {"DataFrame": dict}))
        table = taken.to_dataframe()
        assert list(table) == ["cost", "cost_", "status", "stage", "method", "reason"]
        assert table["cost"].tolist() == taken.points[:, 0].tolist()
        assert {len(column) for column in table.values()} == {len(taken.costs)}

    def test_a_function_that_never_returns_a_number_ends_the_search_early(self) -> None:
        with pytest.raises(ValueError, match=r"none of its first 15 .*it returned None; is a return") as error:
            clearance.search(lambda x: None, {"x": (0.0, 1.0)}, 0.0, **SMALL)
        assert "simulator.name" not in str(error.value)

    def test_a_function_without_a_nominal_value_is_inconclusive(self) -> None:
        result = clearance.search(lambda x: None if 0.4 < x < 0.6 else x, {"x": (0.0, 1.0)}, -1.0, **SMALL)
        assert result.verdict == "inconclusive"
        assert result.nominal.cost is None
        assert "None" in result.nominal.reason


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Accept Ctrl-C as in a terminal: what a script starts in the background ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_keeps_what_was_evaluated() -> None:
    count = 0

    def fly(x: float) -> float:
        nonlocal count
        count += 1
        if count == 50:
            os.kill(os.getpid(), signal.SIGINT)
        return x

    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt) as stopped:
        clearance.search(fly, {"x": (0.0, 1.0)}, -1.0, **SMALL)
    assert isinstance(stopped.value, clearance.Interrupted)
    assert 20 < len(stopped.value.evaluations.costs) < 50
    assert "no verdict" in str(stopped.value)
    assert signal.getsignal(signal.SIGINT) is before
    assert count == 50


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(AttributeError, match=", ".join(clearance.__all__[:5])):
        clearance.serach  # noqa: B018


def test_the_package_is_typed() -> None:
    assert Path(clearance.__file__).with_name("py.typed").is_file()
    assert builtins.all(hasattr(clearance, name) for name in clearance.__all__)
