"""The fixed part of a scene, from the campaign."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sqlalchemy as sa

from backend.catalog.looks import Looks, looks
from backend.catalog.service import described
from backend.db.tables import Run, Trace
from backend.http.errors import RefusedError
from backend.http.versions import readable
from backend.results import service as results
from backend.runs import identity
from backend.runs.service import campaign
from backend.scenes.base import declaration
from backend.scenes.base.axes import Axes, Floats, axes_of
from backend.scenes.base.flight import from_stored
from campaigns import Campaign, Catalogue
from campaigns.asked.criteria import deciding
from campaigns.catalogue import ComponentEntry, ParameterEntry
from campaigns.checked.check import parameters
from campaigns.claims import numbers
from campaigns.documents import JsonObject
from campaigns.identity.identity import UNSTORED, Identity, changes
from campaigns.looks import ObstacleLook
from campaigns.results.scene import Scene
from campaigns.runs import run_name
from campaigns.stages.plan import plan

NOMINAL, WORST = "nominal", "F1"


@dataclass(frozen=True)
class Uncertain:
    path: str
    symbol: str
    unit: str
    text: str
    nominal: float
    low: float
    high: float


@dataclass(frozen=True)
class Setting:
    """The fixed part of a scene in scene coordinates [m], with its labels."""

    run: str
    title: str
    digest: str
    document: JsonObject
    planar: bool
    axes: Axes
    vehicle: str
    start: Floats
    goal: Floats | None
    """None if the vehicle has no goal but follows a course."""
    course: Floats | None
    """The end of the course at the horizon, without a conflict."""
    values: dict[str, float]
    """The nominal values of all parameters by path."""
    moving: list[bool]
    """Whether each obstacle moves."""
    threshold: float
    to_surface: bool
    """Whether the criterion measures to obstacles' surfaces, not to their centres."""
    quantity: str
    unit: str
    horizon: float
    uncertain: list[Uncertain]
    methods: list[tuple[int, str, str]]
    """Position, name and title of each search stage."""
    drawn: Looks = field(default_factory=Looks)
    """The looks of its methods, obstacles and vehicle."""
    obstacles: tuple[str, ...] = ()
    """The component of each obstacle."""
    scene: Scene | None = None
    """What a simulator declares; None for a scenario."""
    identity: Identity = UNSTORED
    """That of the run."""
    worst: str = WORST
    """The finding that the verdict names."""

    @property
    def clears(self) -> bool:
        """Whether the threshold is a distance that must stay clear; of a simulator's result this is not known."""
        return self.scene is None

    @property
    def room(self) -> float:
        """The distance that must stay clear [m]; 0 if there is none."""
        return self.threshold if self.clears else 0.0

    @property
    def criterion(self) -> str:
        """What an evaluation must fulfil, with all digits of the threshold."""
        return f"{self.quantity or 'value'} > {numbers.limit(self.threshold)} {self.unit}".rstrip()

    @property
    def one(self) -> str:
        return "flight" if self.clears else "case"

    @property
    def decimals(self) -> int:
        """Decimals that show the threshold, and thus values near it, with four digits."""
        size = abs(self.threshold)
        return 4 if size == 0 else max(0, min(8, 3 - math.floor(math.log10(size) + 1e-12)))

    def other_code(self, now: Identity | None) -> str:
        """What a simulation of now has otherwise than the run, as a sentence; empty if nothing is known to differ."""
        apart = [] if now is None else changes(self.identity, now)
        if not apart:
            return ""
        return f"Simulated by other code than that of the run: {', '.join(one.name for one in apart)}."

    def look(self, number: int) -> ObstacleLook | None:
        if self.scene is not None:
            return declaration.looks(self.scene)[number]
        return self.drawn.obstacle(self.obstacles[number]) if number < len(self.obstacles) else None

    def free(self, radius: float) -> float:
        """Radius that must stay free about the centre of a round obstacle of that radius [m]; 0 if unknown."""
        if not self.clears:
            return 0.0
        body = self.values.get("criterion.body_radius", 0.0)
        return radius + body + self.threshold if self.to_surface else self.threshold


def drawable(reader: sa.Connection, run_id: int) -> Campaign:
    """The campaign of a run that can be drawn; 404 if it evaluates a simulator whose traces declare no positions."""
    run_campaign = campaign(reader, run_id)
    if run_campaign.scenario is None and scene_of(reader, run_id) is None:
        text = (
            f"{run_name(run_id)} evaluates a simulator, and no stored trace of it states which columns are positions: "
            "it has no 3D view. Declare them under `scene` in its descriptor or decorator"
        )
        raise RefusedError("not-found", text)
    return run_campaign


def scene_of(reader: sa.Connection, run_id: int) -> Scene | None:
    """What a simulator declares with its stored traces, the nominal one first; None without any."""
    nominal = sa.case((Trace.name == NOMINAL, 0), else_=1)
    heads = reader.execute(sa.select(Trace.meta).where(Trace.run_id == run_id).order_by(nominal, Trace.name)).scalars()
    declaration = next((head["scene"] for head in heads if head.get("scene")), None)
    if declaration is None:
        return None
    with readable(f"the 3D view of {run_name(run_id)}", reader, run_id):
        return Scene.model_validate(declaration)


def load(reader: sa.Connection, run_id: int) -> Setting:
    """The setting of a run; 404 if there is no such run, or nothing of it can be drawn."""
    campaign = drawable(reader, run_id)
    if campaign.scenario is None:
        return _declared(reader, run_id, campaign)
    catalogue = described(reader, run_id)
    known = {} if catalogue is None else parameters(campaign, catalogue)
    values = _campaign_values(campaign) | {path: nominal for path, (_, nominal) in known.items()}
    scenario = campaign.given_scenario
    vehicle = None if catalogue is None else catalogue.component("vehicle", scenario.vehicle.component)
    criterion = None if catalogue is None else catalogue.component("criterion", campaign.criterion.component)
    axes = _axes(reader, run_id, vehicle)
    start, goal = _place(values, "start", axes), _place(values, "goal", axes)
    return Setting(
        **_same(reader, run_id, campaign, catalogue),
        planar=vehicle.dimension == 2 if vehicle else axes.frame == "enu",
        axes=axes,
        vehicle=scenario.vehicle.component,
        start=np.zeros(3) if start is None else start,
        goal=goal,
        course=_course(values, axes, scenario.horizon, _climbs(campaign, catalogue, axes)) if goal is None else None,
        values=values,
        moving=_moving(campaign, catalogue),
        to_surface=criterion is not None and criterion.measured_to == "surface",
        horizon=scenario.horizon,
        obstacles=tuple(part.component for part in scenario.obstacles),
    )


def _declared(reader: sa.Connection, run_id: int, campaign: Campaign) -> Setting:
    scene, catalogue = scene_of(reader, run_id), described(reader, run_id)
    assert scene is not None
    stored = sa.select(Trace.name).where(Trace.run_id == run_id)
    flights = [from_stored(results.stored(reader, run_id, name)) for name in reader.scalars(stored).all()]
    there = [flight for flight in flights if flight is not None]
    nominal = results.stored(reader, run_id, NOMINAL)
    first = (None if nominal is None else from_stored(nominal)) or next(iter(there), None)
    return Setting(
        **_same(reader, run_id, campaign, catalogue),
        planar=scene.planar,
        axes=declaration.axes_in(scene),
        vehicle="",
        start=np.zeros(3) if first is None else first.position[0],
        goal=None,
        course=None,
        values=declaration.values(scene),
        moving=[False] * len(scene.obstacles) + [True] * len(scene.bodies),
        to_surface=False,
        horizon=max([0.0, *(float(flight.time[-1]) for flight in there)]) or 1.0,
        scene=scene,
    )


def _same(reader: sa.Connection, run_id: int, campaign: Campaign, catalogue: Catalogue | None) -> dict[str, Any]:
    """The fields that a scenario and a simulator have in the same form."""
    summary = reader.scalar(sa.select(Run.summary).where(Run.id == run_id)) or {}
    decides = None if catalogue is None else deciding(campaign, catalogue)
    return {
        "run": run_name(run_id),
        "worst": (summary.get("worst") or {}).get("finding") or WORST,
        "title": campaign.name,
        "digest": campaign.digest,
        "document": campaign.document(),
        "threshold": campaign.criterion.threshold,
        "quantity": decides.quantity if decides else "",
        "unit": decides.unit if decides else "",
        "uncertain": _uncertain(campaign, {} if catalogue is None else parameters(campaign, catalogue)),
        "methods": searches(campaign, catalogue),
        "drawn": looks(reader, run_id),
        "identity": identity.of_run(reader, run_id) or UNSTORED,
    }


def _campaign_values(campaign: Campaign) -> dict[str, float]:
    """The values that the campaign itself gives, by path, also for unknown components."""
    scenario = campaign.given_scenario
    groups = {"start": scenario.start, "goal": scenario.goal}
    groups |= {f"obstacles.{i}": part.parameters for i, part in enumerate(scenario.obstacles)}
    return {f"{prefix}.{name}": value for prefix, values in groups.items() for name, value in values.items()}


def _moving(campaign: Campaign, catalogue: Catalogue | None) -> list[bool]:
    entries = [
        catalogue.component("obstacle", o.component) if catalogue else None for o in campaign.given_scenario.obstacles
    ]
    return [entry is not None and entry.moving for entry in entries]


def _axes(reader: sa.Connection, run_id: int, vehicle: ComponentEntry | None) -> Axes:
    """The axes of a stored trace; before there is one, those of the vehicle in the current catalogue."""
    stored = reader.scalar(sa.select(Trace.meta).where(Trace.run_id == run_id).limit(1))
    return axes_of((stored or {}).get("frame") or (vehicle.frame if vehicle else None))


def _place(values: Mapping[str, float], prefix: str, axes: Axes) -> Floats | None:
    if f"{prefix}.x" not in values:
        return None
    return axes.drawn(np.array([values.get(f"{prefix}.{axis}", 0.0) for axis in "xyz"]))


def _climbs(campaign: Campaign, catalogue: Catalogue | None, axes: Axes) -> float:
    """The sign of z for a positive climb: up in the axes of the avoider, for any vehicle."""
    avoider = None if catalogue is None else catalogue.component("avoider", campaign.given_scenario.avoider.component)
    return 1.0 if ((avoider.written_in if avoider else "") or axes.frame) == "enu" else -1.0


def _course(values: Mapping[str, float], axes: Axes, horizon: float, climbs: float) -> Floats | None:
    """The end of a course given as speed, heading (from the x towards the y axis) and climb."""
    start = _place(values, "start", axes)
    speed, heading = values.get("goal.speed"), values.get("goal.heading")
    if speed is None or heading is None:
        return None
    climb = values.get("goal.climb", 0.0)
    flat, way = np.cos(climb), speed * horizon
    ahead = way * np.array([flat * np.cos(heading), flat * np.sin(heading), climbs * np.sin(climb)])
    end: Floats = (np.zeros(3) if start is None else start) + axes.drawn(ahead)
    return end


def _uncertain(campaign: Campaign, known: Mapping[str, tuple[ParameterEntry, float]]) -> list[Uncertain]:
    """Parameters of unknown components are omitted."""
    if not known.keys() >= campaign.uncertain.keys():
        return []
    rows = [(path, bounds, *known[path]) for path, bounds in campaign.uncertain.items()]
    return [
        Uncertain(path, entry.symbol, entry.unit, entry.text, nominal, *bounds.interval(nominal))
        for path, bounds, entry, nominal in rows
    ]


def searches(campaign: Campaign, catalogue: Catalogue | None) -> list[tuple[int, str, str]]:
    """Position, name and title of each search stage."""
    titles = {} if catalogue is None else {m.name: m.title for m in catalogue.methods}
    planned = enumerate(plan(campaign))
    return [(k, stage.method, titles.get(stage.method, stage.method)) for k, stage in planned if stage.method]
