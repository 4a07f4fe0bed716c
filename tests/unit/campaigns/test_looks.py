"""Components and methods of other packages are drawn as they declare; every shipped one has its own look."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import viser
from pydantic import ValidationError
from viser import uplot

from backend.catalog.looks import Looks
from backend.reports import figures
from backend.results.improvements import Improvements
from backend.scenes.base.axes import Axes
from backend.scenes.base.palette import DARK, LIGHT
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.bodies import body_of
from backend.scenes.drawing.drawn import MESHES
from backend.scenes.panel.convergence_tab import ConvergenceTab
from campaigns import Catalogue
from campaigns.catalogue import MethodEntry
from campaigns.checked.snapshot import changes
from campaigns.looks import EXTRA, Marker, MethodLook, ObstacleLook, VehicleLook
from tests.given.guest_packages import package
from worker.running.catalogue.installed import catalogue

ROOT = Path(__file__).parents[3]

METHOD = '''"""Guessing."""
from dataclasses import replace
from worker.engine.search.base import MethodLook
from worker.engine.search.methods import direct
method = replace(direct.method, name="guess", title="Guess", look=MethodLook(colour="extra-2", marker="bow"))
'''
PILLAR = '''"""Pillar: a cylinder whose parameters have other names."""
from dataclasses import replace
from typing import Annotated, NamedTuple
from worker.engine.components.obstacles import cylinder
from worker.engine.kernels.component import ObstacleLook, Parameter
class Pillar(NamedTuple):
    position_x: Annotated[float, Parameter("m", "x", -1e6, 1e6, name="position.x")]
    position_y: Annotated[float, Parameter("m", "y", -1e6, 1e6, name="position.y")]
    position_z: Annotated[float, Parameter("m", "z", -1e6, 1e6, name="position.z")]
    girth: Annotated[float, Parameter("m", "Radius", 0.0, 1e5)] = 2.0
    rise: Annotated[float, Parameter("m", "Height", 1e-3, 1e5)] = 9.0
component = replace(
    cylinder.component, name="pillar", parameters=Pillar,
    look=ObstacleLook(shape="cylinder", radius="girth", height={height!r}),
)
'''
SHOW = "from worker.running.catalogue.installed import catalogue; print(catalogue().model_dump_json())"


def installed(folder: Path) -> subprocess.CompletedProcess[str]:
    """What a process reports of the catalogue that has the packages of a folder."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)])}
    return subprocess.run(
        [sys.executable, "-c", SHOW], env=environment, capture_output=True, text=True, timeout=120, check=False
    )


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Catalogue:
    """The catalogue with a method and an obstacle of other packages, as a service reads it."""
    folder = tmp_path_factory.mktemp("packages")
    package(folder, "clearance.methods", "some_guess", METHOD)
    package(folder, "clearance.components", "some_pillar", PILLAR.replace("{height!r}", '"rise"'))
    done = installed(folder)
    assert done.returncode == 0, done.stderr
    return Catalogue.model_validate_json(done.stdout)


def setting(known: Catalogue, methods: list[tuple[int, str, str]]) -> Setting:
    """A scene in space with one obstacle, the pillar."""
    place = {f"obstacles.0.position.{axis}": 1.0 for axis in "xyz"}
    return Setting(
        run="", title="", digest="", document={}, planar=False, axes=Axes(), vehicle="fixed_wing", start=np.zeros(3),
        goal=None, course=None, values=place | {"obstacles.0.girth": 2.0, "obstacles.0.rise": 9.0}, moving=[False],
        threshold=1.0, to_surface=False, quantity="d", unit="m", horizon=1.0, uncertain=[], methods=methods,
        drawn=Looks(known), obstacles=("pillar",),
    )  # fmt: skip


@pytest.mark.nightly
def test_a_method_of_another_package_has_its_own_colour_everywhere(extended: Catalogue) -> None:
    look = Looks(extended).method("guess")
    light, dark = EXTRA["extra-2"]
    assert look == MethodLook(colour=light, dark=dark, marker="bow")
    assert (LIGHT.method(look), DARK.method(look)) == (light, dark)
    svg = figures.convergence([(look.colour, "Guess", [(1.0, 2.0), (9.0, 1.0)])], figures.Quantity("d", "m", 0.5))
    assert light in svg


def test_the_convergence_plot_has_a_colour_for_every_method(extended: Catalogue) -> None:
    methods = [(i, entry.name, entry.title) for i, entry in enumerate(extended.methods)]
    assert len(methods) == len(catalogue().methods) + 1
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        curves = {i: Improvements() for i, _, _ in methods}
        tab = ConvergenceTab(server.gui, setting(extended, methods), LIGHT, curves)
        series: tuple[uplot.Series, ...] = tab._plot.series[1:]
        strokes = {name: one["stroke"] for (_, name, _), one in zip(methods, series, strict=True)}
    finally:
        server.stop()
    assert strokes["guess"] == EXTRA["extra-2"][0]
    assert strokes == {entry.name: entry.look.colour for entry in extended.methods if entry.look}
    assert len(set(strokes.values())) == len(methods)


def test_an_obstacle_of_another_package_has_its_own_shape(extended: Catalogue) -> None:
    scene = setting(extended, [])
    body = body_of(0, scene.values, scene.axes, None, scene.look(0))
    assert (body.kind, body.size) == ("cylinder", (2.0, 9.0))
    assert body_of(0, scene.values, scene.axes, None).kind == "round", "the names of its parameters tell nothing"


@pytest.mark.nightly
def test_a_look_names_parameters_that_there_are(tmp_path: Path) -> None:
    package(tmp_path, "clearance.components", "some_pillar", PILLAR.replace("{height!r}", '"tallness"'))
    done = installed(tmp_path)
    assert done.returncode == 0, done.stderr
    known = Catalogue.model_validate_json(done.stdout)
    assert known.component("obstacle", "pillar") is None
    (skipped,) = known.unusable
    assert "'tallness'" in skipped.text
    with pytest.raises(ValidationError, match="colour"):
        MethodLook.model_validate({"colour": "mauve", "marker": "star"})


def test_every_shipped_method_has_a_colour_and_a_marker_of_its_own() -> None:
    looks = {m.name: m.look for m in catalogue().methods}
    assert None not in looks.values()
    pairs = [(look.colour, look.marker) for look in looks.values() if look]
    markers = {marker for _, marker in pairs}
    assert len({colour for colour, _ in pairs}) == len(pairs) >= 14
    assert len(markers) == min(len(pairs), len(get_args(Marker)) - 1)
    assert "ring" not in markers, "the marker of methods without a look"


def test_every_shipped_obstacle_and_vehicle_has_a_shape() -> None:
    for entry in catalogue().components:
        if entry.role == "obstacle":
            assert isinstance(entry.look, ObstacleLook), entry.name
            assert (entry.look.way != "still") == entry.moving, entry.name
            assert (entry.look.shape in ("circle", "rectangle")) == (entry.dimension == 2), entry.name
        elif entry.role == "vehicle":
            assert isinstance(entry.look, VehicleLook), entry.name
            assert entry.look.mesh in MESHES
        else:
            assert entry.look is None
    assert MESHES["two_wheels"] is shapes.pioneer


def luminance(colour: str) -> float:
    """Relative luminance, WCAG 2.2."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


@pytest.mark.parametrize("name", EXTRA)
def test_a_named_pair_of_colours_is_shown_at_three_to_one_on_every_ground(name: str) -> None:
    css = (ROOT / "frontend/src/theme/tokens.css").read_text(encoding="utf-8")
    for colour, theme in zip(EXTRA[name], css.split(':root[data-theme="dark"]'), strict=True):
        for ground in ("surface", "bg", "sunken"):
            found = re.search(rf"--{ground}: (#\w+);", theme)
            assert found
            written = found[1] if len(found[1]) == 7 else re.sub(r"(\w)", r"\1\1", found[1])
            high, low = sorted((luminance(colour), luminance(written)), reverse=True)
            assert (high + 0.05) / (low + 0.05) >= 3.0


def test_a_stored_look_of_an_earlier_version_named_its_colour() -> None:
    entry = catalogue().methods[0].model_dump(mode="json")
    entry["look"] = {"colour": "cma", "marker": "pentagon", "short": ""}
    assert MethodEntry.model_validate(entry).look is None, "the look of today is used"
    entry["look"]["colour"] = "extra-1"
    look = MethodEntry.model_validate(entry).look
    assert look is not None
    assert (look.colour, look.dark) == EXTRA["extra-1"]


def test_a_catalogue_of_an_earlier_version_has_no_looks_and_stays_as_it_is() -> None:
    now = catalogue()
    document = now.model_dump(mode="json")
    for entry in [*document["components"], *document["methods"]]:
        entry.pop("look", None)
    then = Catalogue.model_validate(document)
    assert then.model_dump(mode="json") == document
    assert changes(then, now) == []
    assert Looks(then, now).method("cma_es") == Looks(now).method("cma_es"), "colours of today"
    assert Looks(then, now).obstacle("cylinder") == Looks(now).obstacle("cylinder")
    assert Looks(then).vehicle("unicycle") is None
