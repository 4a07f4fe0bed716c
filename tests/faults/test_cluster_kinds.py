"""FMUs, Python functions and signals on a cluster: as in local slots, to the bit, and the same files on every node."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.fmu import made
from worker.engine.systems.base import Floats
from worker.engine.systems.simulators.cluster import node
from worker.engine.systems.simulators.cluster.address import SETTING, EvaluatorLost, evaluator
from worker.engine.systems.simulators.cluster.connection import PROMPT, Connection, acquire, release
from worker.engine.systems.simulators.cluster.work import Files, Work
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.engine.systems.simulators.declared.folder import digest_of_place
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator, opened
from worker.engine.systems.simulators.functions import Isolated
from worker.engine.systems.simulators.pooled import Pooled
from worker.engine.systems.simulators.slots.outcome import Limits
from worker.engine.systems.simulators.slots.program import Program
from worker.running.catalogue.files import entry_of, read_file

pytestmark = pytest.mark.nightly  # by day tests/faults/test_cluster.py

LOCAL = "local:1"
IGNORED = r"""while read -r line; do
echo "{\"results\": {\"d\": $((0x$(sed -n s/SigIgn:.//p /proc/self/status) & ~(3 << 31)))}}"
done"""
"""A program whose result are the signals that it ignores, as bits, but 32 and 33, which are the C library's own."""
FUNCTION = """
import clearance

@clearance.simulator(parameters={"x": (0.0, 1.0), "y": (0.0, 1.0)}, timeout=20)
def bowl(x, y):
    if x > 0.9:
        raise ValueError("too far")
    return (x - 0.3) ** 2 + (y - 0.6) ** 2
"""


@pytest.fixture(scope="module")
def there() -> Iterator[Connection]:
    """A cluster of one process, which stays for all tests."""
    connection = acquire(evaluator(LOCAL))
    connection.call(connection.client())
    yield connection
    release(connection)


def test_no_message_waits_for_the_one_before(there: Connection) -> None:
    assert there.connected is not None
    assert there._cluster is not None
    streams = [there.connected.scheduler_comm, *there._cluster.scheduler.stream_comms.values()]
    assert [stream.interval for stream in streams] == [PROMPT, PROMPT]


def test_a_slot_of_a_node_is_closed_once(tmp_path: Path) -> None:
    """Its task and what ends it close it both, and another may have its descriptor by then."""
    program = Program([sys.executable, "-c", "import time; time.sleep(1e6)"], "lines")
    slots = [node.NodeSlot(Work("a", program, Limits(), Files(str(tmp_path), ""))) for _ in range(2)]
    places = [slot._place.path for slot in slots]
    assert all(place.is_dir() for place in places)
    slots[0].close()
    taken = os.open(tmp_path, os.O_RDONLY)
    node._close([slots[0], *slots])
    os.fstat(taken)
    os.close(taken)
    assert not any(place.exists() for place in places)


def function(folder: Path) -> Isolated:
    """The function of a file in this folder."""
    (folder / "bowl.py").write_text(FUNCTION, encoding="utf-8")
    (found,) = read_file(folder / "bowl.py")
    opening = Opening({"simulator.x": 0.5, "simulator.y": 0.5}, "value")
    digest = digest_of_place(found.place)
    return Isolated(found.place, entry_of(found.declaration), opening, found.declaration, digest)


def fmu(folder: Path) -> FmuSimulator:
    """The FMU of a folder."""
    described = read(folder)
    assert isinstance(described, DescribedFmu)
    nominal = {f"simulator.{p.name}": p.default or 0.0 for p in described.entry.parameters}
    return opened(described, Opening(nominal, "separation"))


def compared(kind: Callable[[Path], Pooled], folder: Path, points: Floats, monkeypatch: pytest.MonkeyPatch) -> None:
    """Statuses, costs and reasons are the same here and there, also in fresh processes."""
    found = []
    for address in ("", LOCAL):
        monkeypatch.setenv(SETTING, address)
        simulated = kind(folder)
        try:
            batch, reasons = simulated.evaluate(points)
            again = [(c.cost, c.reason) for c in simulated.compare(points[:1], [None])]
            found.append((batch.status.tolist(), batch.costs.tobytes(), reasons, again, simulated.digest))
            assert type(simulated._pool).__name__ == ("DaskPool" if address else "SlotPool")
        finally:
            simulated.close()
    assert found[0] == found[1]


@pytest.mark.usefixtures("there")
def test_a_function_has_the_same_results_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    points = np.random.default_rng(1).random((20, 2))
    points[3, 0] = 0.95
    compared(function, tmp_path, points, monkeypatch)


@pytest.mark.nightly  # by day a function there; an FMU in slots: tests/fmu/test_evaluation.py
@pytest.mark.usefixtures("there")
def test_an_fmu_has_the_same_results_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = fmu(made.folder(tmp_path, 2))
    usual.close()
    points = np.repeat(usual.nominal[None, :], 6, axis=0)
    points[:, 0] = np.linspace(1.0, 5.0, 6)
    compared(fmu, tmp_path, points, monkeypatch)


@pytest.mark.usefixtures("there")
def test_a_function_whose_file_changed_ends_the_run_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(SETTING, LOCAL)
    simulated = function(tmp_path)
    (tmp_path / "bowl.py").write_text(FUNCTION + "# changed\n", encoding="utf-8")
    try:
        with pytest.raises(EvaluatorLost, match=r"has other files in .* copy the simulator's folder to all nodes"):
            simulated.evaluate(np.array([[0.5, 0.5]]))
    finally:
        simulated.close()


@pytest.mark.parametrize("address", ["", LOCAL])
def test_a_program_ignores_no_signal(
    there: Connection, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: str
) -> None:
    """A simulator that ends what it has started by SIGINT, as PX4 and ROS expect it, would wait in vain."""
    document = {
        "name": "ignored",
        "command": ["sh", "-c", IGNORED],
        "parameters": {"x": {"nominal": 0.5, "low": 0, "high": 1}},
        "results": {"d": {"unit": "m"}},
    }
    (tmp_path / "simulator.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    monkeypatch.setenv(SETTING, address)
    ignored = (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP)  # by a worker after `nohup` or `&`
    before = [signal.signal(number, signal.SIG_IGN) for number in ignored]
    try:
        simulated = CommandSimulator(read(tmp_path), Opening({"simulator.x": 0.5}, "d"))
        try:
            batch, reasons = simulated.evaluate(np.array([[0.5]]))
        finally:
            simulated.close()
    finally:
        for number, handler in zip(ignored, before, strict=True):
            signal.signal(number, handler)
    assert (batch.costs.tolist(), reasons) == ([[0.0]], {})
