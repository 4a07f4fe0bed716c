"""Evaluations on a cluster: the same results as here, and nothing lost or counted twice whatever dies."""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import dask
import numpy as np
import pytest
import yaml

from backend.db.engine import connect
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from campaigns.asked.load import load_document
from campaigns.results.base import FAILED, OK, TIMEOUT
from campaigns.sample_seed import SampleSeed
from campaigns.stages.certify import CertifyResult
from campaigns.stored.records import StagePlan
from tests.faults import stage
from tests.faults.nodes import Cluster, cluster
from tests.faults.processes import command_of, kill, started, until
from tests.migrated import migrated
from tests.simulators import gated, misbehaving, package
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.stages import certify
from worker.engine.stages.parts.context import Context
from worker.engine.systems import optional
from worker.engine.systems.base import Floats
from worker.engine.systems.simulators.cluster import pool as pool_module
from worker.engine.systems.simulators.cluster.address import SETTING, EvaluatorLost, evaluator
from worker.engine.systems.simulators.cluster.pool import DaskPool
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import Described, read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.slots.outcome import Request
from worker.engine.systems.simulators.slots.pool import NEVER
from worker.running.runs.provenance import versions
from worker.running.runs.store import MemoryStore

OPENING = Opening({"simulator.x": 0.5, "simulator.y": 0.5}, "separation")


@pytest.fixture(scope="module")
def nodes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A scheduler with two workers; tests that kill some start others."""
    with cluster(tmp_path_factory.mktemp("nodes"), 2) as made:
        yield made


class Gate:
    """The simulator of `gated`, whose log tells what it began."""

    def __init__(self, folder: Path, free: int) -> None:
        self.folder, self.free = folder, free
        self.described = described(folder, [sys.executable, "-S", "-E", gated.__file__, str(folder), str(free)])

    @property
    def begun(self) -> Counter[str]:
        log = self.folder / "log"
        return Counter(log.read_text().splitlines() if log.exists() else [])

    def open(self) -> None:
        (self.folder / "go").touch()


def described(folder: Path, command: list[str]) -> Described:
    (folder / "simulator").mkdir()
    document = {
        "name": "gated",
        "command": command,
        "parameters": {name: {"nominal": 0.5, "low": 0, "high": 1} for name in "xy"},
        "results": {"separation": {"unit": "m"}},
        "timeout": 60,
    }
    (folder / "simulator" / "simulator.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    return read(folder / "simulator")


def slots(nodes: Cluster, gate: Gate) -> list[int]:
    """The processes of this simulator on the nodes."""
    family = [pid for worker in nodes.workers for pid in worker.family()]
    return [pid for pid in family if str(gate.folder) in command_of(pid)]


def vectors(count: int) -> Floats:
    return np.random.default_rng(3).random((count, 2))


def right(vector: Floats) -> float:
    return gated.separation(*vector.tolist())


def test_results_are_those_of_local_slots_to_the_bit(
    nodes: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = Gate(tmp_path, 10_000)
    here = CommandSimulator(gate.described, OPENING)
    monkeypatch.setenv(SETTING, nodes.address)
    there = CommandSimulator(gate.described, OPENING)
    try:
        of = load_document(package.campaign(), "the campaign")
        asked = vectors(300)
        until(lambda: there.slots == 2, "both nodes")
        assert there.digest == here.digest
        assert (versions(of, here).evaluator, versions(of, there).evaluator) == (None, "dask.distributed")
        assert here.evaluate(asked)[0].costs.tobytes() == there.evaluate(asked)[0].costs.tobytes()
        assert [c.cost for c in there.compare(asked[:2], [None, None])] == [right(v) for v in asked[:2]]
    finally:
        here.close()
        there.close()
    until(lambda: not slots(nodes, gate), "no slot is left on the nodes", 20)


ACTS = (
    "right", "segfault", "hang", "exit code", "killed", "not a number", "missing key", "error", "grandchild",
    "early end", "garbage",
)  # fmt: skip


def test_whatever_a_simulator_does_has_the_same_status_and_sentence(
    nodes: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = {
        "name": "misbehaving",
        "command": [sys.executable, misbehaving.__file__],
        "parameters": {"do": {"nominal": 0, "low": 0, "high": 100}},
        "results": {"d": {"unit": "m"}},
        "timeout": 3,  # which a process that starts on a busy machine must not need
        "memory": 400_000_000,
        "environment": {"MARK": "86398.5"},
        "slots": 2,
    }
    (tmp_path / "simulator.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    points = np.array([[float(list(misbehaving.ACTS).index(act))] for act in ACTS])
    found = []
    for address in ("", nodes.address):
        monkeypatch.setenv(SETTING, address)
        simulator = CommandSimulator(read(tmp_path), Opening({"simulator.do": 0.0}, "d"))
        batch, reasons = simulator.evaluate(points)
        simulator.close()
        # Whether a node's slots had answered anything before the one that hangs is a matter of their order.
        statement = {i: reason.replace(NEVER, "") for i, reason in reasons.items()}
        found.append((batch.status.tolist(), batch.costs.tobytes(), statement))
    assert found[0] == found[1]
    assert found[0][0] == [OK, FAILED, TIMEOUT, *[FAILED] * 7, OK]


def pool_of(gate: Gate, address: str) -> DaskPool:
    simulator = CommandSimulator(gate.described, OPENING)
    simulator.evaluator = evaluator(address)
    pool = simulator._opened()
    assert isinstance(pool, DaskPool)
    return pool


def requests(count: int) -> list[Request]:
    return [{"parameters": {"x": x, "y": y}} for x, y in vectors(count).tolist()]


def line(request: Request) -> str:
    """That of the log."""
    return f"{request['parameters']['x']!r} {request['parameters']['y']!r}".ljust(gated.LINE - 1)


@pytest.mark.parametrize("victim", ["worker", pytest.param("scheduler", marks=pytest.mark.nightly)])
def test_a_killed_node_loses_nothing_and_repeats_only_what_was_running(
    nodes: Cluster, tmp_path: Path, victim: str
) -> None:
    gate, asked = Gate(tmp_path, 20), requests(60)
    with pool_of(gate, nodes.address) as pool:
        futures = [pool.submit(r) for r in asked]
        until(lambda: len(gate.begun) > 20 + 1, "both slots wait")
        before = [k for k, future in enumerate(futures) if future.done()]
        if victim == "worker":
            kill(nodes.workers.pop(0).pid)
        else:
            kill(nodes.scheduler.pid)
            nodes.workers.clear()  # they end with their scheduler
            nodes.schedule()
        nodes.work(2 - len(nodes.workers))
        gate.open()
        results = [future.result(timeout=60).answer["results"]["separation"] for future in futures]
    assert results == [right(v) for v in vectors(60)]
    begun = gate.begun
    assert before
    assert [begun[line(asked[k])] for k in before] == [1] * len(before)
    assert set(begun) == {line(r) for r in asked}
    running = len(asked) - sum(1 for count in begun.values() if count == 1)
    assert 0 < running <= 30


@pytest.mark.nightly  # by day a node that is killed
def test_a_killed_process_repeats_only_what_was_running(
    nodes: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What ended is stored as it arrives; another process goes on with the rest."""
    gate = Gate(tmp_path, 20)
    problem = stage.problem_of(gate.described.folder)
    expected = problem.vectors(stage.points(60))
    lines = [line({"parameters": {"x": x, "y": y}}) for x, y in expected.tolist()]
    url = migrated(tmp_path)
    engine = connect(url)
    with engine.begin() as connection:
        submit(connection, problem.campaign, name="a run", tags=[], owner="", planned=0)
    claim = Queue(engine, lease=600).claim("w")
    assert claim is not None
    store = RunStore(engine, claim)
    command = [sys.executable, "-m", "tests.faults.stage", url, json.dumps(claim.as_json()), str(gate.described.folder)]
    with started([*command, "60"], tmp_path, "first", **{SETTING: nodes.address}) as first:
        until(lambda: len(gate.begun) > 20 + 1 and len(stored(store)) > 10, "both slots wait")
        kill(first.pid)
        first.process.wait()
    before = stored(store)
    gate.open()
    monkeypatch.setenv(SETTING, nodes.address)
    stage.carry_out(url, claim, gate.described.folder, 60)
    columns = store.evaluations(0)
    engine.dispose()
    assert columns is not None
    assert columns.costs[:, 0].tolist() == [right(v) for v in expected]
    begun = gate.begun
    assert [begun[lines[index]] for index in sorted(before)] == [1] * len(before)
    assert set(begun) == set(lines)
    assert max(begun.values()) <= 2


def sampled(gate: Gate, slots: int = 1) -> CertifyResult:
    """A counted sample of the simulator, where the environment says, once there are so many slots."""
    certified = {"certify": {"samples": 300, "keep": "lowest"}}
    of = load_document(package.campaign(stages=package.campaign()["stages"] | certified))
    simulator = CommandSimulator(gate.described, OPENING)
    until(lambda: simulator.slots >= slots, "a node that others killed is replaced")
    problem = Problem(of, simulator)
    store = MemoryStore(sample_seed=SampleSeed(5, stated=True))
    store.plan([StagePlan("certify", None, 300)])
    try:
        return certify.run(Context(of, problem, InProcess(problem), store), 0).result
    finally:
        optional.close(problem.system)


@pytest.mark.nightly  # by day the bits of any results, and a node that is killed
def test_a_counted_sample_has_the_bits_of_local_slots_though_a_node_is_killed(
    nodes: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    here = sampled(Gate(tmp_path / "here", 10_000))
    gate = Gate(tmp_path / "there", 100)
    monkeypatch.setenv(SETTING, nodes.address)
    with ThreadPoolExecutor(1) as threads:
        running = threads.submit(sampled, gate, 2)
        until(lambda: len(gate.begun) > 100 + 1, "both slots wait")
        kill(nodes.workers.pop(0).pid)
        nodes.work(1)
        gate.open()
        there = running.result(timeout=100)
    assert here.blocks is not None
    assert there.blocks == here.blocks
    assert there.sample == here.sample
    assert there.flights == here.flights
    assert (there.evaluations, there.failed) == (300, 0)


def stored(store: RunStore) -> set[int]:
    """The indices of the evaluations that the database has."""
    record, ahead = store.evaluations(0), store.ahead(0)
    done = set(range(0 if record is None else len(record.status)))
    return done | set([] if ahead is None else ahead.indices.tolist())


@pytest.mark.parametrize(("what", "sentence"), [("files", "has other files in"), ("folder", "has no folder")])
def test_a_node_with_other_files_ends_the_run_with_a_sentence(
    nodes: Cluster, tmp_path: Path, what: str, sentence: str
) -> None:
    gate = Gate(tmp_path, 1000)
    with pool_of(gate, nodes.address) as pool:
        if what == "files":
            (gate.described.folder / "more").touch()
        else:
            gate.described.folder.rename(tmp_path / "elsewhere")
        futures = [pool.submit(r) for r in requests(20)]
        with pytest.raises(EvaluatorLost, match=f"node .* {sentence} .*simulator") as lost:
            futures[0].result(timeout=30)
        assert "tcp://127.0.0.1:" in str(lost.value)
        assert all(isinstance(f.exception(timeout=30), EvaluatorLost) for f in futures)
        with pytest.raises(EvaluatorLost):
            pool.submit(requests(1)[0])
    assert not gate.begun


def test_closing_ends_what_runs_on_the_nodes(nodes: Cluster, tmp_path: Path) -> None:
    gate = Gate(tmp_path, 0)
    pool = pool_of(gate, nodes.address)
    futures = [pool.submit(r) for r in requests(20)]
    until(lambda: gate.begun and slots(nodes, gate), "something runs")
    pool.close()
    pool.close()
    assert {f.result(timeout=10).reason for f in futures} == {"cancelled"}
    with pytest.raises(RuntimeError, match="closed"):
        pool.submit(requests(1)[0])
    until(lambda: not slots(nodes, gate), "no slot is left on the nodes", 20)


def test_a_scheduler_that_is_not_there_ends_with_a_sentence(tmp_path: Path) -> None:
    gate = Gate(tmp_path, 0)
    with pytest.raises(EvaluatorLost, match=" 1 s: Timed out"):
        pool_of(gate, "dask://127.0.0.1:1?patience=1")


KILLER = """
import json, os, sys
for line in sys.stdin:
    given = json.loads(line)["parameters"]
    if given["x"] == float(sys.argv[1]):
        guard = open(f'/proc/{os.getppid()}/stat').read()
        os.kill(int(guard.rpartition(')')[2].split()[1]), 9)
    print(json.dumps({"results": {"separation": given["x"]}}), flush=True)
"""


@pytest.mark.nightly
def test_an_evaluation_that_kills_its_node_fails_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a cluster of this machine, which starts its workers again."""
    monkeypatch.setattr(pool_module, "DEATHS", 2)  # each takes a second
    asked = requests(30)
    guilty = asked[11]["parameters"]["x"]
    killer = described(tmp_path, [sys.executable, "-S", "-E", "-c", KILLER, repr(guilty)])
    simulator = CommandSimulator(killer, OPENING)
    simulator.evaluator = evaluator("local:1")
    assert simulator.slots == 1
    batch, reasons = simulator.evaluate(vectors(30))
    simulator.close()
    assert [k for k, status in enumerate(batch.status) if status != OK] == [11]
    assert np.delete(batch.costs[:, 0], 11).tolist() == np.delete(vectors(30)[:, 0], 11).tolist()
    died = r"a node died while evaluating this, 2 times; the last one was (tcp|tls)://127\.0\.0\.1:"
    assert re.match(died, reasons[11])  # encrypted where `cryptography` is installed


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("files", "why"), [("", "none are configured"), ("/no/such/file", "No such file")])
def test_tls_without_certificates_is_refused_at_once(tmp_path: Path, files: str, why: str) -> None:
    gate = Gate(tmp_path, 0)
    names = {"ca-file": files, "client.cert": files, "client.key": files}
    with (
        dask.config.set({f"distributed.comm.tls.{name}": file or None for name, file in names.items()}),
        pytest.raises(EvaluatorLost, match=f"TLS .*{why}"),
    ):
        pool_of(gate, "dask+tls://127.0.0.1:1")
