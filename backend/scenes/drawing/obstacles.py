"""Draws the obstacles with their safety radius, moving ones along their tracks.

If flights differ in an obstacle, each has its own; otherwise it is drawn once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import viser

from backend.scenes.base import declaration
from backend.scenes.base.axes import along
from backend.scenes.base.palette import Palette, Rgb, rgb, shade
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.bodies import Body, body_of
from backend.scenes.drawing.drawn import Drawn, anchor_of
from backend.scenes.drawing.labels import Label, Tag
from backend.scenes.drawing.solids import Solids
from backend.scenes.drawing.world import World


@dataclass(eq=False)
class _Group:
    name: str
    body: Body
    members: list[Drawn] = field(default_factory=list)
    own: bool = False
    """Whether it differs in other flights."""
    titles: list[str] = field(default_factory=list)
    """The titles of its flights when it was drawn."""
    nodes: list[Any] = field(default_factory=list)
    root: Any = None
    heading: Any = None
    label: Any = None
    """Its viser node."""
    wanted: Label | None = None
    """Its label relative to its centre."""

    @property
    def visible(self) -> bool:
        return not self.members or any(one.visible for one in self.members)

    @property
    def called(self) -> list[str]:
        return [one.style.title for one in self.members]

    def takes_over(self, before: dict[str, _Group], span: float) -> bool:
        """Reuse an existing drawing that looks the same, and remove it from `before`."""
        old = before.get(self.name)
        if old is None or old.own != self.own or old.members != self.members or old.titles != self.called:
            return False
        if not old.body.like(self.body, span) or _longer(self.body, old.body):
            return False
        self.nodes, self.root, self.heading, self.titles = old.nodes, old.root, old.heading, old.titles
        self.label, self.wanted = old.label, old.wanted
        del before[self.name]
        return True

    def move(self, time: float) -> None:
        if self.body.flight is None or self.root is None:
            return
        self.root.position = self.body.at(time)
        self.heading.wxyz = along(self.body.heading(time))


class Obstacles:
    def __init__(self, server: viser.ViserServer, setting: Setting, palette: Palette, world: World) -> None:
        self._scene, self._setting, self._palette, self._world = server.scene, setting, palette, world
        self._solids = Solids(server)
        self._groups: list[_Group] = []

    def update(self, drawn: Sequence[Drawn], time: float) -> None:
        before = {group.name: group for group in self._groups}
        self._groups = self._grouped([one for one in drawn if one.flight is not None])
        new = [group for group in self._groups if not group.takes_over(before, self._world.frame.span)]
        for group in before.values():
            for node in group.nodes:
                node.remove()
        for group in new:
            self._draw(group)
        self.show()
        self.move(time)

    def move(self, time: float) -> None:
        for group in self._groups:
            group.move(time)

    def show(self) -> None:
        for group in self._groups:
            for node in group.nodes:
                node.visible = group.visible

    def tags(self, time: float) -> Iterator[Tag]:
        for group in self._groups:
            if group.visible and group.wanted is not None:
                centre = group.body.at(time)
                yield Tag(replace(group.wanted, place=centre + group.wanted.place), group.label, centre)

    def moving(self) -> Iterator[tuple[Body, Rgb]]:
        """The visible moving obstacles, each with its colour."""
        for group in self._groups:
            if group.visible and group.body.flight is not None:
                yield group.body, shade(self._colour(group), 0.8)

    def paint(self, palette: Palette, time: float) -> None:
        self._palette = palette
        for group in self._groups:
            for node in group.nodes:
                node.remove()
            group.nodes = []
            self._draw(group)
        self.show()
        self.move(time)

    def _grouped(self, shown: Sequence[Drawn]) -> list[_Group]:
        found: list[_Group] = []
        for number, moving in enumerate(self._setting.moving):
            same: list[_Group] = []
            if not shown and not moving:  # the track of a moving obstacle is part of a flight
                same = [_Group(f"/obstacles/{number}", self._body(number, None))]
            for one in shown:
                body = self._body(number, one)
                group = next((g for g in same if g.body.like(body, self._world.frame.span)), None)
                if group is None:
                    name = f"/obstacles/{number}" + (f"-{one.style.key}" if same else "")
                    group = _Group(name, body)
                    same.append(group)
                elif _longer(body, group.body):
                    group.body = body
                group.members.append(one)
            for group in same:
                group.own = len(same) > 1
            found += same
        return found

    def _body(self, number: int, one: Drawn | None) -> Body:
        flight = None if one is None else one.flight
        values = self._setting.values | ({} if flight is None else flight.parameters)
        return body_of(number, values, self._setting.axes, flight, self._setting.look(number))

    def _draw(self, group: _Group) -> None:
        body, colour = group.body, self._colour(group)
        group.titles = group.called
        group.root = self._scene.add_frame(group.name, show_axes=False, position=body.place)
        group.nodes = [group.root]
        if self._setting.planar:
            self._flat(group, colour)
        else:
            self._solid(group, colour)
        if body.flight is not None:
            self._track(group, colour)
        self._label(group)

    def _colour(self, group: _Group) -> Rgb:
        return rgb(group.members[0].style.colour if group.own else self._palette.obstacle)

    def _flat(self, group: _Group, colour: Rgb) -> None:
        """Draw a planar obstacle: a body of some height, and the disc that must stay free with a dashed edge."""
        unit, name, body = self._world.frame.unit, group.name, group.body
        height = 1.2 * unit
        if body.flight is None:
            self._solids.cylinder(f"{name}/core", 0.12 * unit, height, colour, 1.0)
        if body.kind == "box":
            self._solids.box(f"{group.name}/body", (*body.size[:2], height), height / 2, group.body.turn, colour)
        elif body.size[0] > 0:
            self._solids.cylinder(
                f"{name}/body", body.size[0], height if body.flight is None else 0.4 * unit, colour, 0.45
            )
        if not self._setting.clears:
            return
        middle = np.array([0.0, 0.0, 0.03 * height])
        if self._setting.to_surface and body.kind == "box":
            ring = shapes.rounded(middle, body.size[:2], body.turn, self._setting.free(0.0))
        else:
            free = self._setting.free(body.size[0])
            self._solids.cylinder(f"{name}/safety", free, 0.02 * height, colour, 0.25)
            ring = shapes.circle(middle, free, dashes=24)
        self._solids.line(f"{name}/ring", ring, rgb(self._palette.ink))

    def _solid(self, group: _Group, colour: Rgb) -> None:
        """Draw a spatial obstacle: the body, and what must stay free as a wire frame if it is a ball or a capsule."""
        unit, name, body = self._world.frame.unit, group.name, group.body
        if body.kind == "box":
            self._solids.box(f"{group.name}/body", body.size, 0.0, group.body.turn, colour)
        elif body.kind == "cylinder":
            self._solids.cylinder(f"{name}/body", body.size[0], body.size[1], colour, 0.45, lift=0.0)
            if self._setting.to_surface or not self._setting.clears:
                return
            capsule = shapes.capsule(self._setting.threshold, body.size[1])
            self._solids.mesh(f"{name}/safety", capsule, colour, wireframe=True, opacity=0.25)
            return
        elif body.size[0] > 0.2 * unit:
            self._solids.ball(f"{name}/body", body.size[0], colour, opacity=0.45)
        if body.flight is None and body.extent <= 0.2 * unit:
            self._solids.ball(f"{name}/core", 0.2 * unit, colour)
        free = 0.0 if self._setting.to_surface and body.kind == "box" else self._setting.free(body.size[0])
        if free > 0:
            self._solids.ball(f"{name}/safety", free, colour, wireframe=True, opacity=0.25)

    def _track(self, group: _Group, colour: Rgb) -> None:
        name, span, unit = group.name, self._world.frame.span, self._world.frame.unit
        lift = np.array([0.0, 0.0, 0.003 * span if self._setting.planar else 0.0])
        dashes = shapes.dashed(group.body.track + lift, span / 70)
        if len(dashes):
            track = f"/tracks/{name.rpartition('/')[2]}"
            group.nodes.append(self._solids.line(track, dashes, shade(colour, 0.85), 2.5))
        group.heading = self._scene.add_frame(f"{name}/heading", show_axes=False)
        if self._setting.planar:
            # on top of its body, its middle at the centre
            sign = shapes.arrow()
            moved = unit * (sign.vertices - (0.4, 0.0, 0.0)) + (0.0, 0.0, 0.45 * unit)
            self._solids.mesh(f"{name}/heading/sign", shapes.Mesh(moved, sign.faces), shade(colour, 0.7))
        else:
            for part, mesh, share in zip(("body", "rest"), shapes.aircraft(), (0.85, 0.5), strict=True):
                scaled = shapes.Mesh(unit * mesh.vertices, mesh.faces)
                self._solids.mesh(f"{name}/heading/{part}", scaled, shade(colour, share))

    def _label(self, group: _Group) -> None:
        setting, body = self._setting, group.body
        words: list[str] = []
        if setting.scene is not None:
            words += filter(None, [declaration.names(setting.scene)[body.number]])
        elif body.flight is not None:
            words.append("intruder" if len(setting.moving) == 1 else f"intruder {body.number + 1}")
        if group.own:
            words += [
                one.style.title if one.style.title.startswith("F") else one.style.title.lower() for one in group.members
            ]
        if group is self._groups[0] and setting.clears:
            words.append(setting.criterion)
        if not words:
            return
        # Below its safety radius; if flights differ in it and both are near, the second label is above.
        second = "-" in group.name
        off = setting.room + (body.extent if setting.to_surface or not setting.clears else 0.0)
        off += body.size[1] / 2 if body.kind == "cylinder" and setting.clears else 0.0
        off = off if second or not setting.clears else -off
        away = np.array([0.0, off, 0.0] if setting.planar else [0.0, 0.0, off])
        anchor = anchor_of(group.members, "bottom" if second else "top")
        group.wanted = Label(f"{group.name}/label", ", ".join(words), away, anchor, 0.8)
        group.label = self._solids.label(group.wanted)


def _longer(one: Body, other: Body) -> bool:
    if one.flight is None or other.flight is None:
        return False
    return bool(one.flight.time[-1] > other.flight.time[-1])
