"""The contract of components in simulation: alone or combined, compiled or plain."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from campaigns.catalogue import ParameterEntry
from campaigns.results.base import EXCLUDED, FAILED, OK
from clearance.testing.problems import Problem
from clearance.testing.scenes import STEP, drawn, near
from worker.engine.systems.base import Floats

Entries = Mapping[str, ParameterEntry]


def unbreakable(flown: Problem, of: Entries, count: int) -> None:
    """Within the limits of these parameters nothing crashes and nothing is hidden."""
    vectors = drawn(flown, of, count)
    batch, reasons = flown.system.simulate_vectors(vectors)
    ok = batch.status == OK
    assert np.isfinite(batch.costs[ok]).all()
    assert np.isnan(batch.costs[~ok]).all()
    assert batch.costs.shape == (len(vectors), len(flown.results))
    assert set(np.unique(batch.status)) <= {OK, FAILED, EXCLUDED}
    assert sorted(reasons) == np.flatnonzero(~ok).tolist()
    begins = ("the simulation ", "the vehicle ", f"{flown.results[0].quantity} starts at or below ", "excluded ")
    assert all(reason.startswith(begins) for reason in reasons.values())


def repeated(flown: Problem, of: Entries, count: int) -> None:
    """Check that the same vectors give the same bits again."""
    vectors = drawn(flown, of, count)
    batch, again = (flown.system.simulate_vectors(vectors)[0] for _ in range(2))
    assert again.costs.tobytes() == batch.costs.tobytes()
    assert again.status.tolist() == batch.status.tolist()


def in_any_order(flown: Problem, of: Entries, count: int) -> None:
    """Compiled, several are simulated side by side: none depends on its neighbours. In plain Python each is alone."""
    vectors = drawn(flown, of, count)
    batch, again = (flown.system.simulate_vectors(rows)[0] for rows in (vectors, vectors[::-1]))
    assert again.costs[::-1].tobytes() == batch.costs.tobytes()


def no_number_shows(flown: Problem, of: Entries) -> None:
    """A value that is no number fails the flight or changes nothing: NaN never comes out as a cost that looks like one.

    A parameter that this flight does not use may be anything.
    """
    vectors = np.repeat(flown.system.nominal[None, :], len(of) + 1, axis=0)
    for row, path in enumerate(of, 1):
        vectors[row, flown.paths[path]] = np.nan
    batch, _ = flown.system.simulate_vectors(vectors)
    for row, path in enumerate(of, 1):
        assert batch.status[row] != OK or np.array_equal(batch.costs[row], batch.costs[0]), path


def as_in_plain_python(compiled: Problem, plain: Problem, of: Entries, count: int) -> None:
    """Check that both forms give the same status, costs and trace."""
    vectors, steps = near(compiled, of, count), 24
    one, other = (p.system.loop.simulate(vectors, STEP, steps, traced=1) for p in (compiled, plain))
    assert one.status.tolist() == other.status.tolist()
    ok = one.status == 0.0
    assert ok.any()
    assert _close(one.costs[ok], other.costs[ok], 1e-12)
    assert _close(one.trace, other.trace, 1e-9)


def _close(one: Floats, other: Floats, tolerance: float) -> bool:
    """Within the tolerance, relatively or absolutely, and NaN in the same places."""
    missing = np.isnan(other)
    allowed = np.maximum(tolerance * np.abs(other), tolerance)
    return bool((np.isnan(one) == missing).all() and (np.abs(one - other) <= allowed)[~missing].all())
