"""What `clearance component new` writes: a whole component of each kind, and a small campaign that runs with it."""

from __future__ import annotations

from pathlib import Path

from campaigns.catalogue import Role
from campaigns.limits import SEARCH
from clearance.cli import WrongInputError

_WORKER = Path(__file__).parents[2] / "worker"
_COMPONENTS = _WORKER / "engine" / "components"


_SHIPPED = {"environment": ("environment/ground_slope.py", "ground_slope", "GroundSlope", "Slope of the ground")}
"""Kinds that begin with a shipped component: its file, name, class and title."""
_UNCERTAIN = {
    "controller": "controller.K_p: {low: 6.0, high: 10.0, unit: N s/m}",
    "avoider": "avoider.reach: {low: 2.0, high: 4.0, unit: m}",
    "obstacle": "obstacles.0.swing: {low: 0.8, high: 1.5, unit: m}",
    "environment": "environment.0.x: {low: -0.05, high: 0.05}",
    "fault": "faults.0.offset: {low: -0.3, high: 0.3, unit: m}",
}
"""A parameter of the component that its campaign makes uncertain."""
_GAINS = {"environment": ", parameters: {K_i1: 3.0}"}
"""On a slope the speed's usual integral gain creeps to the goal for minutes, far beyond the horizon."""
_CAMPAIGN = """\
# clearance run {name}.yaml
name: {title}, a first campaign
summary: A ground robot passes a post, with the {kind} {name}.

scenario:
  vehicle: {{component: {vehicle}}}
  controller: {{component: {controller}{gains}}}
  avoider: {{component: {avoider}}}
  start: {{x: 0.0, y: 0.0}}
  goal: {{x: 6.0, y: 7.0}}
  obstacles:
    - component: {obstacle}
      parameters: {{position: {{x: 4.0, y: 4.0}}, radius: 0.5}}{more}
  horizon: 15.0
  step: 0.005

uncertain:
  vehicle.m: {{low: 4.0, high: 6.0, unit: kg}}{uncertain}

criterion: {{component: {criterion}, threshold: 0.1}}

stages:
  search:
    - {{method: {method}, evaluations: 4000}}
  certify: {{samples: 300}}
"""


def files(kind: Role, name: str, vehicle: str, folder: Path) -> dict[Path, str]:
    """The files of a new component by path: its own, that of a new vehicle's controller, and the campaign.

    vehicle: the one that a controller is for; empty for all that it fits.
    """
    fits = _fitting(vehicle) if kind == "controller" else ()
    found = {folder / f"{name}.py": _written(kind, name, fits)}
    controller = ""
    if kind == "vehicle":  # no other controller has it in its `fits`
        controller, vehicle = f"{name}_controller", name
        found[folder / f"{controller}.py"] = _written("controller", controller, (name,))
    return found | {folder / f"{name}.yaml": _campaign(kind, name, vehicle or "unicycle", controller or "pid_speed")}


def _written(kind: Role, name: str, fits: tuple[str, ...]) -> str:
    usual = (f"running/skeletons/{kind}.py", f"my_{kind}", f"My{kind.capitalize()}", f"My {kind}")
    path, old_name, old_type, old_title = usual
    file = _WORKER / path
    if kind in _SHIPPED:
        path, old_name, old_type, old_title = _SHIPPED[kind]
        file = _COMPONENTS / path
    type_name = "".join(part.capitalize() for part in name.split("_"))
    text = file.read_text(encoding="utf-8")
    for old, new in ((old_name, name), (old_type, type_name), (old_title, name.replace("_", " ").capitalize())):
        text = text.replace(old, new)
    listed = ", ".join(f'"{each}"' for each in fits)
    return text.replace('fits=("unicycle",)', f"fits=({listed},)") if fits else text


def _campaign(kind: Role, name: str, vehicle: str, controller: str) -> str:
    """A ground robot passes a post; the component takes the place of a shipped one, with its default parameters."""
    usual = {
        "vehicle": vehicle,
        "controller": controller,
        "avoider": "potential_field",
        "obstacle": "circle",
        "criterion": "surface_separation",
    }
    parts = usual | {kind: name}
    more = {"environment": "environment", "fault": "faults"}.get(kind)
    return _CAMPAIGN.format(
        method=SEARCH,
        **parts | {"more": f"\n  {more}: [{{component: {name}}}]" if more else ""},
        gains=_GAINS.get(kind, ""),
        name=name,
        title=name.replace("_", " ").capitalize(),
        kind=kind,
        uncertain=f"\n  {_UNCERTAIN[kind]}" if kind in _UNCERTAIN else "",
    )


def _fitting(vehicle: str) -> tuple[str, ...]:
    """The vehicles that the skeleton of a controller fits: the requested one, or all whose states it assumes.

    Read from the files as they are written: nothing is executed.
    """
    from worker.running.catalogue import own

    files = [*sorted((_COMPONENTS / "vehicles").glob("*.py")), *own.files(), *sorted(Path.cwd().glob("*.py"))]
    known: dict[str, own.Signals | None] = {}
    for file in files:
        declared = own.declared_as(file)
        if declared is not None and declared[0] == "Vehicle":
            known.setdefault(declared[1], own.signals(file))
    pattern = known["unicycle"]
    assert pattern is not None
    fits = [name for name, signals in known.items() if signals == pattern]
    if not vehicle:
        return tuple(fits)
    if vehicle in fits:
        return (vehicle,)
    if vehicle not in known:
        from campaigns.checked import texts

        raise WrongInputError(f"--for {vehicle}: no such vehicle; {texts.known(vehicle, known)}")
    raise WrongInputError(
        f"--for {vehicle}: the template is for the states {', '.join(pattern.states)} and the inputs "
        f"{' and '.join(pattern.inputs)}; begin with a copy of a controller for a vehicle like yours, from "
        "worker/engine/components/controllers"
    )
