"""Traces of FMUs: variables at the communication points, without any change of the results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.fmu import made
from worker.engine.systems.base import NoTrace
from worker.engine.systems.simulators.declared import fmu
from worker.engine.systems.simulators.declared.descriptor import BadDescriptor, read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator, opened

TRACE: dict[str, Any] = {"height": {"variable": "z", "text": "Height", "symbol": "z_1"}, "x": None}


def simulator(folder: Path, result: str) -> FmuSimulator:
    described = read(folder)
    assert isinstance(described, fmu.DescribedFmu)
    return opened(
        described, Opening({f"simulator.{p.name}": p.default or 0.0 for p in described.entry.parameters}, result)
    )


@pytest.mark.parametrize("fmi", [pytest.param(2, marks=pytest.mark.nightly), 3])  # by day others of this file have 2
def test_variables_are_recorded_at_the_communication_points(tmp_path: Path, fmi: int) -> None:
    simulated = simulator(made.folder(tmp_path, fmi, described={"trace": TRACE}), "height")
    before, _ = simulated.evaluate(simulated.nominal[None])
    found = simulated.trace("nominal", {})
    thrown = simulated.trace("F1", {"simulator.speed": 20.0})
    after, _ = simulated.evaluate(simulated.nominal[None])
    simulated.close()
    assert found is not None
    assert thrown is not None
    assert [(c.name, c.symbol, c.unit, c.text) for c in found.columns] == [
        ("time", "time", "s", ""),
        ("height", "z_1", "m", "Height"),
        ("x", "x", "m", ""),
    ]
    assert found.data.shape == (301, 3)
    assert found.data[:, 0] == pytest.approx(np.linspace(0.0, 3.0, 301))
    assert found.data[:, 1].max() == found.meta.cost == before.costs[0, 0] == after.costs[0, 0]
    assert thrown.data[-1, 2] > found.data[-1, 2]


@pytest.mark.nightly
def test_the_example_shows_the_fall_to_the_ground_and_no_further(tmp_path: Path) -> None:
    """Of which the trace and the 3D view are part; a load that has landed passes no mast below the ground."""
    simulated = simulator(made.example(tmp_path), "separation")
    values = {"simulator.mass": 4.0, "simulator.speed": 12.0, "simulator.wind": 1.0}
    found = simulated.trace("F1", values)
    simulated.close()
    assert found is not None
    assert found.meta.scene is not None
    time, x, z, separation = found.data.T
    assert [column.name for column in found.columns] == ["time", "x", "z", "separation"]
    landed = z < 0.0
    assert -0.2 < z.min() < 0.0
    assert time[landed][0] == pytest.approx(4.42, abs=0.02)
    assert np.ptp(x[landed]) == 0.0
    assert found.meta.cost == separation.min() == pytest.approx(abs(x[-1] - 32.0))


def test_a_trace_of_an_evaluation_that_fails_is_a_sentence(tmp_path: Path) -> None:
    simulated = simulator(made.folder(tmp_path, 2, described={"trace": TRACE}), "height")
    with pytest.raises(NoTrace, match=r"fmi2DoStep .* t = 0\.49 s"):
        simulated.trace("F1", {"simulator.trouble": 1.0})
    batch, reasons = simulated.evaluate(simulated.nominal[None])
    simulated.close()
    assert reasons == {}
    assert np.isfinite(batch.costs).all()


def test_a_long_trace_has_every_kth_point_and_the_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fmu, "ROWS", 40)
    simulated = simulator(made.folder(tmp_path, 2, described={"trace": TRACE}), "far")
    found = simulated.trace("nominal", {})
    simulated.close()
    assert found is not None
    assert 30 < len(found.data) <= 40
    assert found.data[:2, 0] == pytest.approx([0.0, 0.08])
    assert found.data[-1, 0] == pytest.approx(3.0)
    assert found.data[-1, 2] == found.meta.cost


@pytest.mark.parametrize(
    ("trace", "reason"),
    [
        ({"time": None}, "trace.time: the time of the communication points is added by itself; remove it"),
        ({"height": None}, "trace.height.variable: model.fmu has no variable height; its outputs are x, z, separation"),
        ({"drag": None}, "trace.drag.variable: drag is Boolean; one real number is expected"),
        ({"z": {"unit": "ft"}}, "trace.z.unit: the model states m, not ft"),
        ({"z": {"title": "Height"}}, "trace.z.title: unknown key; remove it or correct its spelling"),
    ],
)
def test_a_column_that_cannot_be_read_is_refused(tmp_path: Path, trace: Any, reason: str) -> None:
    with pytest.raises(BadDescriptor) as refused:
        read(made.folder(tmp_path, 2, described={"trace": trace}))
    assert reason in str(refused.value)
