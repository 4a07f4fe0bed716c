"""Noise that a function does not show: of a seed that it has by default, and behind a store of results."""

from __future__ import annotations

import functools
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clearance
from campaigns.checked.foreseen import undeclared
from clearance.function.result import Result
from tests.audited import audited
from worker.engine.systems.simulators.declared.function import constants
from worker.engine.systems.simulators.declared.stores import stores
from worker.running.catalogue.files import entry_of, read_file

AB: dict[str, tuple[float, float]] = {"a": (0.0, 1.0), "b": (0.0, 1.0)}


def seeded(a: float, b: float, seed: int = 3) -> float:
    gust = np.random.default_rng(int(seed)).normal()
    return float(3.0 - 0.8 * a * a - 0.5 * b + 0.6 * min(gust, 0.0))


def first(seed: int, a: float, b: float) -> float:
    return seeded(a, b, seed)


def options(a: float, b: float, **others: Any) -> float:
    return seeded(a, b, others["noise_seed"])


@functools.wraps(seeded)
def wrapped(*args: Any, **kwargs: Any) -> float:
    return seeded(*args, **kwargs)


@functools.cache
def stored(a: float, b: float) -> float:
    return 3.0 - 0.8 * a * a - 0.5 * b + 0.003 * random.gauss(0.0, 1.0)


def through(a: float, b: float) -> float:
    return stored(a, b)


class Plant:
    """An object whose class has a method with the name of what clears a store."""

    def __init__(self) -> None:
        self.calls = 0

    @functools.lru_cache  # noqa: B019
    def method(self, a: float, b: float) -> float:
        return stored.__wrapped__(a, b)

    @staticmethod
    @functools.cache
    def static(a: float, b: float) -> float:
        return stored.__wrapped__(a, b)

    def cache_clear(self, what: str) -> None:
        raise AssertionError(what)


PLANT = Plant()


def by_method(a: float, b: float) -> float:
    return PLANT.method(a, b)


def by_class(a: float, b: float) -> float:
    return Plant.static(a, b)


def by_default(a: float, b: float, plant: Plant = PLANT) -> float:
    return plant.method(a, b)


def searched(call: Callable[..., Any]) -> Result:
    return clearance.search(call, AB, threshold=1.3, methods={"direct": 150, "mlsl": 150}, validation=1500)


def failing(result: Result) -> list[str]:
    return [check.text for check in result.verdict.checks if check.standing != "holds"]


@pytest.mark.parametrize(
    ("call", "seeds"),
    [
        (seeded, {"seed": "3"}),
        (wrapped, {"seed": "3"}),
        (functools.partial(seeded, seed=4), {"seed": "4"}),
        (functools.partial(functools.partial(seeded, seed=4), seed=5), {"seed": "5"}),
        (functools.partial(first, 7), {"seed": "7"}),
        (functools.partial(np.vectorize(seeded)), {"seed": "3"}),
        (functools.partial(options, noise_seed=8), {"noise_seed": "8"}),
        (lambda a, b, *, random_state=0: a, {"random_state": "0"}),
        (lambda a, b, rng=2: a, {"rng": "2"}),
        # Other noise in each call is noise that is measured, and other parameters are none.
        (lambda a, b, seed=None: a, {}),
        (lambda a, b, rng=random.Random(1): a, {}),  # noqa: B008
        (lambda a, b, rng=np.random.default_rng: a, {}),
        (lambda a, b, gain=2.0, seeding=1: a, {}),
        (lambda a, b, reseed=True: a, {}),
        (min, {}),
    ],
)
def test_a_seed_that_every_call_has_is_named(call: Callable[..., Any], seeds: dict[str, str]) -> None:
    named = clearance.simulator(parameters=AB, name="f")(call) if call is not min else None
    assert named is None or entry_of(named.declaration).seeds == seeds
    assert {name: value for name, value in constants(call, AB).items() if name in seeds} == seeds
    assert "seed" not in constants(seeded, {**AB, "seed": 1})


def test_a_seed_that_every_call_has_bars_cleared_as_a_declared_one(tmp_path: Path) -> None:
    for call in (seeded, functools.partial(seeded, seed=3)):
        result = searched(call)
        assert result.verdict != "cleared"
        (why,) = failing(result)  # nothing else bars it
        assert why == undeclared({"seed": "3"})
    result.save(tmp_path / "out")
    audited(tmp_path / "out")


def test_the_seed_of_a_function_in_a_file_is_named(tmp_path: Path) -> None:
    file = tmp_path / "drop.py"
    file.write_text(
        "import clearance\n\n@clearance.simulator(parameters={'a': (0, 1)})\ndef drop(a, seed=3):\n    return a\n"
    )
    (function,) = read_file(file)
    assert function.entry.seeds == {"seed": "3"}


def test_a_store_of_results_answers_no_call_that_shows_whether_they_repeat() -> None:
    for call in (stored, through, functools.partial(through)):
        result = searched(call)
        assert result.verdict != "cleared"


def test_stores_are_found_where_the_code_names_them() -> None:
    def inner(a: float) -> float:
        return stored(a, 0.0)

    for call in (stored, through, functools.partial(stored, 1.0), inner, np.vectorize(stored)):
        stored(0.0, 0.0)
        for clear in stores(call):
            clear()
        assert stored.cache_info().currsize == 0
    assert stores(seeded) == []


@pytest.mark.parametrize("call", [by_method, by_class, by_default, PLANT.method, functools.partial(map, Plant.static)])
def test_stores_of_methods_are_found_and_a_method_of_that_name_is_not_called(call: Callable[..., Any]) -> None:
    PLANT.method(0.0, 0.0)
    Plant.static(0.0, 0.0)
    for clear in stores(call):
        clear()
    assert 0 in (Plant.method.cache_info().currsize, Plant.static.cache_info().currsize)


def test_a_table_is_not_read_for_each_call_that_shows_whether_results_repeat() -> None:
    read: list[float] = []

    @functools.cache
    def table(scale: float) -> float:
        read.append(scale)
        return 3.0 * scale

    result = searched(lambda a, b: table(1.0) - 0.8 * a * a - 0.5 * b)
    assert result.verdict == "cleared"
    assert 1 < len(read) < 10


def test_values_that_have_no_text_are_no_error() -> None:
    class Odd:
        def __repr__(self) -> str:
            raise RuntimeError

        def __getattr__(self, name: str) -> Any:
            raise RuntimeError(name)

    assert list(constants(lambda a, b, odd=Odd(), data=[0] * 10**6: a, AB)) == ["odd", "data"]  # noqa: B008
