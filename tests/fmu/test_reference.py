"""The Reference FMUs of the Modelica Association, of both FMI versions, where a machine has them.

CLEARANCE_REFERENCE_FMUS names the folder of a release, with 2.0/BouncingBall.fmu, 3.0/BouncingBall.fmu and the others:
https://github.com/modelica/Reference-FMUs.
"""

from __future__ import annotations

import math
import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from worker.engine.systems.simulators.declared.descriptor import BadDescriptor, read
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator, opened

FOLDER = os.environ.get("CLEARANCE_REFERENCE_FMUS", "")
pytestmark = [
    pytest.mark.skipif(not FOLDER, reason="CLEARANCE_REFERENCE_FMUS names no folder of the Reference FMUs"),
    pytest.mark.parametrize("fmi", ["2.0", "3.0"]),
]
BALL: dict[str, Any] = {
    "parameters": {"e": {}, "g": {"low": -20.0, "high": -1.0}},
    "results": {
        "lowest": {"variable": "h", "take": "minimum"},
        "fastest": {"variable": "v", "take": "maximum"},
        "contact": {"variable": "h", "take": "first_crossing", "level": 0.01, "direction": "falling"},
        "height": {"variable": "h", "take": "final"},
    },
    "trace": {"h": None, "v": None},
}
OSCILLATOR: dict[str, Any] = {
    "parameters": {"mu": {"low": 0.0, "high": 5.0}},
    "results": {
        "most": {"variable": "x0", "take": "maximum"},
        "least": {"variable": "x1", "take": "minimum"},
        "turns": {"variable": "x0", "take": "first_crossing", "level": 0.0, "direction": "falling"},
        "last": {"variable": "x0", "take": "final"},
    },
}
DECAY: dict[str, Any] = {
    "parameters": {"k": {"low": 0.1, "high": 2.0}},
    "results": {"x": {"variable": "x", "take": "final"}},
}


def described(at: Path, fmi: str, model: str, given: dict[str, Any]) -> DescribedFmu:
    """A reference FMU with a descriptor."""
    at.mkdir(parents=True, exist_ok=True)
    shutil.copy(Path(FOLDER) / fmi / f"{model}.fmu", at / "model.fmu")
    (at / "simulator.yaml").write_text(yaml.safe_dump({"name": "model", "fmu": "model.fmu", "slots": 1} | given))
    found = read(at)
    assert isinstance(found, DescribedFmu)
    return found


def simulator(found: DescribedFmu, result: str) -> FmuSimulator:
    return opened(found, Opening({f"simulator.{p.name}": p.default for p in found.entry.parameters}, result))


def values(found: DescribedFmu, *cases: tuple[float, ...]) -> dict[str, list[float]]:
    """Every result of the cases, each from a simulator that is asked for it alone."""
    taken = {}
    for result in found.descriptor.results:
        simulated = simulator(found, result)
        batch, reasons = simulated.evaluate(np.array(cases, dtype=float))
        simulated.close()
        assert reasons == {}
        taken[result] = batch.costs[:, 0].tolist()
    return taken


def test_what_the_model_states_is_read(tmp_path: Path, fmi: str) -> None:
    found = described(tmp_path, fmi, "BouncingBall", BALL)
    e, g = found.entry.parameters
    assert (e.name, e.unit, e.low, e.high, e.default, e.text) == ("e", "", 0.5, 1.0, 0.7, "Coefficient of restitution")
    assert (g.name, g.unit, g.default) == ("g", "m/s2", -9.81)
    assert {r.name: r.unit for r in found.entry.results} == {
        "lowest": "m", "fastest": "m/s", "contact": "s", "height": "m",
    }  # fmt: skip
    assert (found.model.version, found.stop, found.step, found.steps) == (fmi, 3.0, 0.01, 300)


def test_the_ball_falls_and_bounces(tmp_path: Path, fmi: str) -> None:
    """Closed forms of a fall from 1 m; the model integrates by Euler's method with steps of 1 ms."""
    found = values(described(tmp_path, fmi, "BouncingBall", BALL), (0.7, -9.81), (1.0, -9.81), (0.7, -2.0))
    for k, (e, g) in enumerate([(0.7, 9.81), (1.0, 9.81), (0.7, 2.0)]):
        assert found["contact"][k] == pytest.approx(math.sqrt(2 * 0.99 / g), abs=0.002)
        assert found["fastest"][k] == pytest.approx(e * math.sqrt(2 * g), abs=0.02 * g)
        assert -0.01 < found["lowest"][k] < 0.05
    early = described(tmp_path / "early", fmi, "BouncingBall", BALL | {"stop": 0.3, "results": {
        "height": {"variable": "h", "take": "final"}, "lowest": {"variable": "h", "take": "minimum"},
    }})  # fmt: skip
    found = values(early, (0.7, -9.81))
    assert found["height"] == found["lowest"] == pytest.approx([1.0 - 0.5 * 9.81 * 0.09], abs=0.002)


def test_the_oscillator_follows_its_equation(tmp_path: Path, fmi: str) -> None:
    found = values(described(tmp_path, fmi, "VanDerPol", OSCILLATOR), (1.0,), (3.0,))
    for k, mu in enumerate((1.0, 3.0)):
        times = np.linspace(0.0, 20.0, 2001)
        exact = solve_ivp(
            lambda _, x, mu=mu: (x[1], mu * (1.0 - x[0] ** 2) * x[1] - x[0]), (0.0, 20.0), (2.0, 0.0),
            method="DOP853", t_eval=times, rtol=1e-10, atol=1e-10,
        ).y  # fmt: skip
        falls = times[np.flatnonzero((exact[0, :-1] > 0.0) & (exact[0, 1:] <= 0.0))[0]]
        assert found["most"][k] == pytest.approx(exact[0].max(), abs=0.05)
        assert found["least"][k] == pytest.approx(exact[1].min(), rel=0.05)
        assert found["turns"][k] == pytest.approx(falls, abs=0.05)


def test_the_decay_is_that_of_the_models_own_steps(tmp_path: Path, fmi: str) -> None:
    """Euler's method with 100 steps of 0.1 s, exactly."""
    found = values(described(tmp_path, fmi, "Dahlquist", DECAY), (1.0,), (0.5,))
    assert found["x"] == pytest.approx([0.9**100, 0.95**100], rel=1e-9)


@pytest.mark.parametrize(
    ("model", "given", "result"),
    [("BouncingBall", BALL, "fastest"), ("VanDerPol", OSCILLATOR, "last"), ("Dahlquist", DECAY, "x")],
)
def test_one_instance_is_reset_and_repeats_to_the_bit(
    tmp_path: Path, fmi: str, model: str, given: dict[str, Any], result: str
) -> None:
    found = described(tmp_path, fmi, model, given)
    simulated = simulator(found, result)
    nominal = simulated.nominal
    low = np.array([p.low for p in found.entry.parameters])
    batch, reasons = simulated.evaluate(np.array([nominal, 0.5 * (nominal + low), nominal]))
    (confirmed,) = simulated.confirm(nominal[None, :], [None])
    simulated.close()
    assert reasons == {}
    assert simulated.reuse.how == "reset", simulated.reuse
    assert batch.costs[0, 0] == batch.costs[2, 0] == confirmed.cost == confirmed.comparisons[-1].cost
    assert batch.costs[0, 0] != batch.costs[1, 0]


def test_a_trace_has_the_communication_points(tmp_path: Path, fmi: str) -> None:
    simulated = simulator(described(tmp_path, fmi, "BouncingBall", BALL), "height")
    found = simulated.trace("nominal", {})
    simulated.close()
    assert found is not None
    assert [(column.name, column.unit) for column in found.columns] == [("time", "s"), ("h", "m"), ("v", "m/s")]
    assert found.data.shape == (301, 3)
    assert found.data[-1, 1] == found.meta.cost
    # The speed is the slope of the height, also over a bounce within a step.
    assert found.data[:40, 2] == pytest.approx(-9.81 * found.data[:40, 0], abs=1e-9)


def test_a_model_of_whole_numbers_is_refused_with_what_is_expected(tmp_path: Path, fmi: str) -> None:
    """Stair counts seconds and has no parameter."""
    kind = "Integer" if fmi == "2.0" else "Int32"
    with pytest.raises(
        BadDescriptor, match=f"results.counter.variable: counter is {kind}; one real number is expected"
    ):
        described(tmp_path, fmi, "Stair", {"results": {"counter": {"variable": "counter", "take": "final"}}})
    with pytest.raises(BadDescriptor, match="has no parameter and no input that is a real number"):
        described(tmp_path, fmi, "Stair", {"results": {"end": {"variable": "time", "take": "final"}}})


def test_an_input_passes_through_and_further_variables_are_set(tmp_path: Path, fmi: str) -> None:
    given = {
        "parameters": {"fed": {"variable": "Float64_continuous_input", "low": -2.0, "high": 2.0, "nominal": 0.5}},
        "results": {"out": {"variable": "Float64_continuous_output", "take": "final"}},
        "set": {"Int32_input": 3, "Boolean_input": True},
    }
    with pytest.raises(BadDescriptor, match="step: the model states none; give it in seconds"):
        described(tmp_path, fmi, "Feedthrough", given)
    given |= {"step": 0.1}
    found = described(tmp_path, fmi, "Feedthrough", given)
    assert values(found, (0.5,), (-1.25,)) == {"out": [0.5, -1.25]}
