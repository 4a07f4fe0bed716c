"""The arguments of a search beyond its budget: options, starts, validation, agreement, workers, resume."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clearance
from campaigns.claims.lowest_value import unconfirmed
from campaigns.claims.spans import words
from clearance.function.request import _at_top
from tests.faults.processes import REPOSITORY

RANGES = {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}
METHODS = {"direct": 60, "sqp": 60, "cma_es": 60}


def margin(mass: float, drag: float) -> float:
    return 60.0 - 10.0 * abs(mass - 1.9) - 30.0 * drag


def searched(**changes: Any) -> clearance.Result:
    given: dict[str, Any] = {"methods": METHODS, "certify": 20, "validation": 300}
    return clearance.search(margin, RANGES, 40.0, **given | changes)


def test_the_example_of_the_guide_runs() -> None:
    guide = (REPOSITORY / "docs" / "python.md").read_text(encoding="utf-8")
    (example,) = [b for b in re.findall(r"```python\n(.*?)```", guide, re.DOTALL) if "resume=first" in b]
    space: dict[str, Any] = {}
    exec(example, space)
    first, more = space["first"], space["more"]
    assert (more.method == "cma_es").sum() == 120
    assert (first.costs[first.method == "cma_es"] == more.costs[more.method == "cma_es"][:60]).all()


def test_the_guide_has_every_argument() -> None:
    guide = (REPOSITORY / "docs" / "python.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \|", guide.partition("| argument |")[2].partition("\n\n")[0], re.MULTILINE)
    listed = re.findall(r"`(\w+)`", " ".join(rows))
    assert sorted(listed) == sorted(list(inspect.signature(clearance.search).parameters)[1:])


def test_options_starts_and_agreement_are_those_of_the_campaign() -> None:
    found = searched(options={"direct": {"iterations": 3}}, starts=[{"mass": 1.6}], agreement=0.1)
    direct, sqp, _ = found.origin.campaign.stages.search
    assert (direct.options, direct.starts, sqp.starts) == ({"iterations": 3}, [], [{"simulator.mass": 1.6}])
    assert found.origin.campaign.agreement == 0.1
    assert (found.points[found.method == "sqp"][0] == [1.6, 0.5 * (0.1 + 0.2)]).all()
    assert found.origin.campaign.stages.validate_.evaluations == 300


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"options": {"turbo": {}}}, "options: 'turbo'"),
        ({"options": {"direct": {"depth": 1}}}, "depth"),
        ({"starts": [{"speed": 1.0}]}, "no parameter 'speed'"),
        ({"starts": [{"mass": 9.0}]}, "mass"),
        ({"starts": [{"mass": 1.6}], "methods": ["direct"]}, "takes start points"),
        ({"validation": -1}, "validation must be"),
        ({"agreement": 0.0}, "agreement must be"),
        ({"workers": 0}, "workers must be"),
        ({"resume": "nowhere"}, "resume: nowhere"),
    ],
)
def test_what_cannot_be_used_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        searched(**changes)


def test_the_numbers_of_numpy_are_numbers() -> None:
    many = np.array([60, 20, 300])
    of_numpy = searched(
        methods={"direct": many[0], "sqp": many[0]}, certify=many[1], validation=many[2], seed=np.uint8(3),
        options={"direct": {"iterations": np.int32(3)}}, starts=[{"mass": np.float64(1.6)}], agreement=np.float32(0.5),
    )  # fmt: skip
    plain = searched(
        methods={"direct": 60, "sqp": 60}, certify=20, validation=300, seed=3, options={"direct": {"iterations": 3}},
        starts=[{"mass": 1.6}], agreement=0.5,
    )  # fmt: skip
    assert of_numpy.origin.campaign == plain.origin.campaign
    with pytest.raises(ValueError, match="certify must be"):
        searched(certify=np.float64(20.0))
    with pytest.raises(ValueError, match="seed must be"):
        searched(seed=np.True_)


def test_a_saved_or_interrupted_search_is_resumed_without_evaluating_it_again(tmp_path: Path) -> None:
    first, called = searched(), [0]
    again = searched(resume=first.save(tmp_path))
    assert again.costs.tobytes() == first.costs.tobytes()
    assert again.sample_seed == first.sample_seed

    def stops(mass: float, drag: float) -> float:
        called[0] += 1
        if called[0] == 150:
            raise KeyboardInterrupt
        return 60.0 - 10.0 * abs(mass - 1.9) - 30.0 * drag

    with pytest.raises(clearance.Interrupted) as interrupted:
        clearance.search(stops, RANGES, 40.0, methods=METHODS)
    done = len(interrupted.value.evaluations.costs)
    with pytest.raises(ValueError, match="another simulator"):
        searched(resume=interrupted.value)
    assert 0 < done < 150
    for threshold in (40.0, 60.0):
        called[0] = 0
        with pytest.raises(clearance.Interrupted) as interrupted:
            clearance.search(stops, RANGES, threshold, methods=METHODS)
        lowest = float(interrupted.value.evaluations.costs.min())
        stated = words(unconfirmed("cancelled", lowest, threshold, ""))
        assert (stated in str(interrupted.value), stated != "") == (True, lowest <= threshold)


def test_a_folder_whose_campaign_is_another_one_is_not_resumed(tmp_path: Path) -> None:
    folder = searched().save(tmp_path)
    text = (folder / "campaign.json").read_text(encoding="utf-8")
    (folder / "campaign.json").write_text(text.replace("2.3", "2.4"), encoding="utf-8")
    wider = RANGES | {"mass": (1.5, 2.4)}
    with pytest.raises(ValueError, match="not the campaign"):
        clearance.search(margin, wider, 40.0, methods=METHODS, certify=20, validation=300, resume=folder)


def test_a_result_that_could_not_be_saved_leaves_the_earlier_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = searched(), searched(seed=2)
    folder = first.save(tmp_path)
    before = {file.name: file.read_bytes() for file in folder.iterdir()}

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("clearance.local.results._write_bits", full)
        with pytest.raises(OSError, match="No space"):
            second.save(folder)
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before
    (folder / "trace-F9.csv").touch()
    second.save(folder)
    assert not (folder / "trace-F9.csv").exists(), "of an earlier result"
    assert searched(resume=folder, seed=2).costs.tobytes() == second.costs.tobytes()


@pytest.mark.parametrize("name", ["evaluations.csv", "campaign.json", "trace-F1.csv"])
def test_a_result_replaces_no_file_that_no_result_wrote(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"own")
    (tmp_path / "trace-mine.csv").write_bytes(b"own")
    with pytest.raises(FileExistsError, match=name):
        searched().save(tmp_path)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {name: b"own", "trace-mine.csv": b"own"}
    (tmp_path / name).unlink()
    searched().save(tmp_path)
    searched().save(tmp_path)
    assert (tmp_path / "trace-mine.csv").read_bytes() == b"own"


def test_a_search_does_not_end_because_it_cannot_be_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    def closed(*_: object, **__: object) -> None:
        raise OSError(5, "the terminal is gone")

    monkeypatch.setattr("builtins.print", closed)
    shown = searched(progress=True, sample_seed=1)
    assert shown.costs.tobytes() == searched(sample_seed=1).costs.tobytes()


def _drawn(found: clearance.Result) -> bytes:
    (at,) = [k for k, stage in enumerate(found.origin.store.stages) if stage.plan.kind == "certify"]
    columns = found.origin.store.evaluations(at)
    assert columns is not None
    return bytes(columns.points.tobytes())


def test_a_sample_is_not_extended_once_its_result_is_known(tmp_path: Path) -> None:
    first = searched()
    for earlier in (first, first.save(tmp_path)):
        larger = searched(certify=40, resume=earlier)
        assert larger.sample_seed != first.sample_seed
        assert not _drawn(larger).startswith(_drawn(first))
        assert (larger.costs[larger.method == "direct"] == first.costs[first.method == "direct"]).all()
    assert _drawn(searched(resume=first)) == _drawn(first)
    seed = larger.origin.store.sample_seed
    assert seed is not None
    assert not seed.stated


def test_a_seed_that_is_stated_is_that_of_the_sample_or_refused() -> None:
    first = searched()
    assert searched(certify=40, resume=first, sample_seed=5).sample_seed == 5
    assert searched(resume=first, sample_seed=first.sample_seed).sample_seed == first.sample_seed
    with pytest.raises(ValueError, match="leave sample_seed out"):
        searched(resume=first, sample_seed=5)


def test_a_search_of_another_criterion_or_of_other_stages_is_not_resumed() -> None:
    first = searched()
    with pytest.raises(ValueError, match="another seed"):
        searched(resume=first, seed=2)
    with pytest.raises(ValueError, match="other stages"):
        searched(resume=first, methods={"direct": 60})


@pytest.mark.nightly
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.nightly)])
def test_workers_give_the_same_numbers(workers: int) -> None:
    beside = searched(workers=workers, methods={"direct": 30}, validation=20)
    here = searched(methods={"direct": 30}, validation=20)
    assert np.array_equal(beside.costs[beside.method == "direct"], here.costs[here.method == "direct"])


@pytest.mark.nightly  # by day tests/unit/evidence/verdicts/test_sureness.py
def test_a_chance_of_a_lower_case_is_stated_without_workers_only() -> None:
    """It was set on searches in one process; with workers the members of `auto` have other shares."""
    alone, beside = (searched(methods={"auto": 120}, workers=workers) for workers in (None, 2))
    assert (alone.verdict.sureness is None, beside.verdict.sureness is None) == (False, True)


PROGRAMS = {
    "def fly(x): return x": True,
    "try:\n    from fast import fly\nexcept ImportError:\n    def fly(x): return x": True,
    "fly = decorated(other)": True,
    "if __name__ == '__main__':\n    def fly(x): return x": False,
    "if __name__ != '__main__':\n    pass\nelse:\n    def fly(x): return x": True,
    "other = 1": False,
    "def (": False,
}


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_process_of_its_own_finds_what_a_program_defines_wherever_it_is_loaded(tmp_path: Path, program: str) -> None:
    file, found = tmp_path / "program.py", PROGRAMS[program]
    file.write_text(program, encoding="utf-8")
    assert _at_top("__main__", str(file), "fly") == found
    assert _at_top("package", str(file), "fly"), "a module is loaded as it is here"
    assert not _at_top("__main__", "<stdin>", "fly")


def test_what_to_do_about_a_function_that_is_not_in_a_file_is_what_was_given() -> None:
    with pytest.raises(ValueError, match="workers=2 is given") as refused:
        clearance.search(lambda x: x, {"x": (0.0, 1.0)}, 0.0, workers=2)
    assert str(refused.value).endswith("or omit workers")
    assert "isolated" not in str(refused.value)
