"""The plain form on Python's numbers has every bit of the plain form on numpy's."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest

from campaigns import library, load_file
from tests.given.at_night import nightly_but
from worker.engine.kernels import maths, scalars
from worker.engine.kernels.bind import plain
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop import assemble
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.opening import opened

ODD = (0.0, -0.0, 0.5, -0.5, 3.0, -3.0, -1e-300, 1e15 + 0.5, -(2.0**53), 1e299, 1e308, math.inf, -math.inf, math.nan)


@pytest.mark.parametrize("x", [*ODD, *map(np.float64, ODD)])
def test_floor_is_numpys(x: float) -> None:
    assert np.float64(scalars.floor(x)).tobytes() == np.floor(x).tobytes()


@np.errstate(over="ignore")  # random bits are products of whole numbers that wrap
def test_samples_of_noise_are_the_same() -> None:
    kept = scalars.instead()
    for asked in itertools.product((0.0, 7.0, 123456789.0), (0.0, 3.0), (-1.0, 0.0, 41.0)):
        assert kept[maths.normals](*asked) == tuple(plain(maths.normals)(*asked))
        assert kept[maths.uniform](*asked) == plain(maths.uniform)(*asked)


@pytest.mark.by_day(3)
@pytest.mark.parametrize("name", nightly_but(list(library())[::4], library()))
def test_a_shipped_loop_has_the_same_bits(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    flights = opened.flights(load_file(library()[name]), compiled=False, lanes=1)
    given = flights.realisations.flights(flights.nominal[None])[:1]
    quick = flown(Loop(flights.parts, 1, compiled=False), given)
    monkeypatch.setattr(assemble, "quick", plain)
    assert flown(Loop(flights.parts, 1, compiled=False), given) == quick


def flown(loop: Loop, params: Floats) -> list[bytes]:
    """Every bit that 25 steps and an observation give; a NaN is a NaN, whatever its sign."""
    found = loop.simulate(params, 0.02, 25, 5, traced=1)
    seen = loop.observe(found.trace[0], params[0], 0.02)
    results = found.costs, found.status, found.when, found.trace, seen
    return [np.where(np.isnan(result), np.nan, result).tobytes() for result in results]


def divided(out):  # type: ignore[no-untyped-def]
    out[0] = 1.0
    out[1] = -1.0 / np.floor(0.5)


def test_what_python_raises_is_infinite_as_in_compiled_code() -> None:
    out = np.zeros(2)
    with pytest.raises(ZeroDivisionError):
        plain(divided, scalars.instead())(out)
    with np.errstate(all="ignore"):
        scalars.quick(divided)(out)
    assert out.tolist() == [1.0, -math.inf]


def rooted(out):  # type: ignore[no-untyped-def]
    out[0] = abs((np.floor(0.5) - 2.0) ** 0.5)


def nested(out):  # type: ignore[no-untyped-def]
    out[0] = (lambda x: abs((x - 2.0) ** x))(np.floor(0.5) + 0.5)


def squared(out):  # type: ignore[no-untyped-def]
    out[0] = (np.floor(0.5) - 2.0) ** 2 + (np.floor(1.5) - 2.0) ** 3.0


@pytest.mark.parametrize("function", [rooted, nested])
def test_what_python_makes_complex_is_nan_as_in_compiled_code(function: Callable[..., None]) -> None:
    out = np.zeros(1)
    plain(function, scalars.instead())(out)
    assert out[0] > 1.0, "the magnitude of a complex number"
    with np.errstate(all="ignore"):
        scalars.quick(function)(out)
    assert math.isnan(out[0])


def test_whole_powers_are_quick(monkeypatch: pytest.MonkeyPatch) -> None:
    out = np.zeros(1)
    flown = scalars.quick(squared)
    monkeypatch.setattr(scalars, "plain", lambda function: pytest.fail("numpy's numbers are not needed"))
    flown(out)
    assert flown.__code__ is not squared.__code__
    assert out[0] == 3.0


def test_noise_follows_an_edit_of_the_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    with np.errstate(over="ignore"):
        before = scalars.instead()[maths.normals](7.0, 3.0, 41.0)
        monkeypatch.setattr(maths, "TWO_PI", 3.0)  # as in a notebook
        after = scalars.instead()[maths.normals](7.0, 3.0, 41.0)
        assert after == tuple(plain(maths.normals)(7.0, 3.0, 41.0)) != before
