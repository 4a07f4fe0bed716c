"""Every common mistake in a component: the line, and one sentence that says what to do."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.given.at_night import nightly_but, rows_nightly_but
from tests.given.component_mistakes import COMPILED, DECLARED, FLOWN, READ, Slip
from worker.engine.components import own as own_package
from worker.engine.kernels.component import Component, Vehicle, declared
from worker.running.catalogue.installed import components, source_of
from worker.running.examination import compiling, examine, flying, reading, units
from worker.running.examination.declaring import _check_kernel, declared_by
from worker.running.examination.flying import flown
from worker.running.examination.kernels import kernels
from worker.running.examination.mistake import Mistake

SKELETONS = Path(__file__).parents[4] / "worker" / "running" / "skeletons"
KINDS = ("vehicle", "controller", "avoider", "obstacle", "fault", "criterion")
WORDS = 60
"""The longest sentence."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder whose files are modules of the package of own components."""
    monkeypatch.setattr(own_package, "__path__", [str(tmp_path)])
    monkeypatch.setenv("CLEARANCE_COMPONENTS", str(tmp_path))
    yield tmp_path
    for name in [name for name in sys.modules if name.startswith("worker.engine.components.own.")]:
        del sys.modules[name]
        vars(own_package).pop(name.rpartition(".")[2], None)


def written(folder: Path, slip: Slip) -> tuple[Path, str]:
    """A skeleton with this mistake; its file, and its text."""
    text = (SKELETONS / f"{slip.kind}.py").read_text(encoding="utf-8")
    assert text.count(slip.old) >= 1, "the skeleton has changed"
    text = text.replace(slip.old, slip.new, 1)
    if "np." in slip.new:
        text = text.replace("from typing", "import numpy as np\nfrom typing", 1)
    text = text.replace("return 1.0 / p.m,", "return twice(1.0 / p.m),") if "def twice" in slip.new else text
    file = folder / f"{slip.kind}.py"
    file.write_text(text, encoding="utf-8")
    return file, text


def found(file: Path) -> Mistake:
    """The first mistake in a file, found without the compiler."""
    source = reading.read(file)
    reading.check(source)
    component = declared_by(source, f"worker.engine.components.own.{file.stem}")
    flown(component, source, lambda _: None)
    pytest.fail("no mistake was found")


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulations of three seconds instead of thirty, for what does not depend on how long they are."""
    monkeypatch.setattr(flying, "LONG", 300)


def reported(mistake: Mistake, text: str, slip: Slip) -> None:
    """The mistake is the expected one, in the line with the expected text."""
    assert re.search(slip.text, mistake.text), f"line {mistake.line}: {mistake.text}"
    line = text.splitlines(keepends=True)[mistake.line - 1] if mistake.line else ""
    assert slip.at in line, f"line {mistake.line} ({line.strip()}): {mistake.text}"
    assert "\n" not in mistake.text
    assert len(mistake.text.split()) <= WORDS
    assert not re.search(r"numba|nopython|Traceback|0x", mistake.text, re.IGNORECASE)


LATE = {"a reach that is too small after the start"}
"""What shows only in long simulations."""


@pytest.mark.by_day(22)
@pytest.mark.parametrize("slip", [*READ, *DECLARED, *FLOWN], ids=lambda slip: slip.what)
def test_a_mistake_is_one_sentence_with_its_line(slip: Slip, folder: Path, request: pytest.FixtureRequest) -> None:
    if slip.what not in LATE:
        request.getfixturevalue("short")
    file, text = written(folder, slip)
    with pytest.raises(Mistake) as raised:
        found(file)
    reported(raised.value, text, slip)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("slip", COMPILED, ids=lambda slip: slip.what)
def test_a_mistake_that_only_the_compiler_finds(slip: Slip, folder: Path) -> None:
    file, text = written(folder, slip)
    result = examine.examine(file, {})
    reported(Mistake(result.text, result.line), text, slip)


@pytest.mark.parametrize("kind", nightly_but(("avoider",), KINDS))
def test_what_is_written_to_start_from_can_be_used(kind: str, folder: Path) -> None:
    file = folder / f"my_{kind}.py"
    file.write_text((SKELETONS / f"{kind}.py").read_text(encoding="utf-8"), encoding="utf-8")
    result = examine.examine(file, {})
    assert (result.text, result.line) == ("", 0)
    assert (result.role, result.name, result.simulated) == (kind, f"my_{kind}", True)


@pytest.mark.by_day(1)
@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("kind", nightly_but(("avoider", "fault"), KINDS))
def test_a_component_may_be_of_a_subclass(kind: str, folder: Path) -> None:
    file, whole = folder / f"own_{kind}.py", f"component = {kind.capitalize()}("
    text = (SKELETONS / f"{kind}.py").read_text(encoding="utf-8")
    assert whole in text
    mine = f"class Mine({kind.capitalize()}):\n    pass\n\n\ncomponent = Mine("
    file.write_text(text.replace(whole, mine), encoding="utf-8")
    source = reading.read(file)
    reading.check(source)
    flown(declared_by(source, f"worker.engine.components.own.{file.stem}"), source, lambda _: None)


STATES = """

@kernel
def wake(p: MyObstacle) -> tuple[float]:
    return (p.radius,)


@kernel
def move(t: float, o: tuple[float], q: tuple[float, float], v: tuple[float, float], p: MyObstacle) -> tuple[float]:
    return (GROWTH,)


component = Obstacle(
    states=1,
    wake=wake,
    move=move,
"""


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("growth", ["0.0", "0.1"])
def test_a_reach_holds_along_the_states_of_an_obstacle(growth: str, folder: Path) -> None:
    text = (SKELETONS / "obstacle.py").read_text(encoding="utf-8")
    text = text.replace("\n\ncomponent = Obstacle(\n", STATES.replace("GROWTH", growth)).replace(
        "o: tuple[()]", "o: Any"
    )
    text = text.replace("distance - p.radius,", "distance - o[0],").replace("import Annotated", "import Annotated, Any")
    file = folder / "inflated.py"
    file.write_text(text, encoding="utf-8")
    if growth == "0.0":
        source = reading.read(file)
        assert flown(declared_by(source, "worker.engine.components.own.inflated"), source, lambda _: None)
        return
    with pytest.raises(Mistake, match=r"reach is 0\.5 m .* at t = 0\.2 s"):
        found(file)


SHIPPED = pytest.mark.parametrize("component", components().values(), ids=lambda c: f"{c.role}-{c.name}")


@SHIPPED
def test_shipped_components_keep_the_rules(component: Component) -> None:
    source = reading.read(Path(str(source_of(component).__file__)))
    reading.check(source)
    reading.check_names(source)
    for slot in kernels(component):
        _check_kernel(slot, source)
    own = [component.parameters, *([component.start] if isinstance(component, Vehicle) else [])]
    assert [units.unknown(p.unit) for each in own for p in declared(each) if units.unknown(p.unit)] == []


@pytest.mark.nightly
@SHIPPED
def test_shipped_components_return_what_is_expected(component: Component) -> None:
    """Also one whose kernels are those of its planar form: results are checked in the file that has them."""
    functions = [inspect.unwrap(getattr(slot.function, "py_func", slot.function)) for slot in kernels(component)]
    files = {Path(inspect.getfile(function)) for function in functions}
    with_kernels = [file for file in sorted(files) if "components" in file.parts]
    assert with_kernels
    for file in with_kernels:
        assert flown(component, reading.read(file), lambda _: None)


@pytest.mark.by_day(1)
@pytest.mark.usefixtures("short")
@pytest.mark.parametrize(
    ("without", "noted"),
    rows_nightly_but(
        [(("rate=",), True), (("look=", "moving="), False)],
        [(("rate=",), True), (("rate=", "moving="), True), (("look=", "moving="), False)],
    ),
)
def test_an_obstacle_that_moves_at_no_declared_rate_is_noted(
    without: tuple[str, ...], noted: bool, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = (SKELETONS / "obstacle.py").read_text(encoding="utf-8").splitlines(keepends=True)
    file = folder / "swinging.py"
    file.write_text("".join(s for s in lines if not s.strip().startswith(without)), encoding="utf-8")
    monkeypatch.setattr(compiling, "compile_each", lambda *_: None)
    result = examine.examine(file, {})
    assert (result.text, result.note) == ("", examine.RATE if noted else "")


@pytest.mark.by_day(1)
@pytest.mark.usefixtures("short")
@pytest.mark.parametrize(
    ("kind", "without", "note"),
    [
        ("obstacle", "reach=", examine.REACH),
        ("criterion", "measured_to=", examine.MEASURED),
        ("fault", "switches=", examine.SWITCHES),
    ],
)
def test_what_a_component_does_not_declare_is_noted(
    kind: str, without: str, note: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = (SKELETONS / f"{kind}.py").read_text(encoding="utf-8").splitlines(keepends=True)
    assert any(line.strip().startswith(without) for line in lines)
    monkeypatch.setattr(compiling, "compile_each", lambda *_: None)
    for name, text in {
        "whole": lines, "lacking": [s for s in lines if not s.strip().startswith(without)],
    }.items():  # fmt: skip
        file = folder / f"{name}.py"
        file.write_text("".join(text), encoding="utf-8")
        result = examine.examine(file, {})
        assert (result.text, result.note) == ("", note if name == "lacking" else "")
