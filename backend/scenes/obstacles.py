"""Draws the obstacles with their safety radius, moving ones along their tracks. Start reading at `Obstacles`.

Where flights differ in an obstacle, each has its own; where they agree, it is drawn once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import viser

from backend.scenes import shapes
from backend.scenes.axes import along
from backend.scenes.bodies import Body, body_of
from backend.scenes.drawn import Drawn, anchor_of
from backend.scenes.palette import Palette, Rgb, rgb, shade
from backend.scenes.setting import Setting
from backend.scenes.world import LINE, World


@dataclass(eq=False)
class _Group:
    """One obstacle as some flights have it."""

    name: str
    body: Body
    members: list[Drawn] = field(default_factory=list)
    own: bool = False
    """Whether other flights have it otherwise."""
    titles: list[str] = field(default_factory=list)
    """What its flights were called when it was drawn."""
    nodes: list[Any] = field(default_factory=list)
    root: Any = None
    heading: Any = None

    @property
    def visible(self) -> bool:
        return not self.members or any(one.visible for one in self.members)

    @property
    def called(self) -> list[str]:
        return [one.style.title for one in self.members]

    def takes_over(self, before: dict[str, _Group], span: float) -> bool:
        """Go on with what is drawn already, where that looks the same; it is no longer among those before."""
        old = before.get(self.name)
        if old is None or old.own != self.own or old.members != self.members or old.titles != self.called:
            return False
        if not old.body.like(self.body, span) or _longer(self.body, old.body):
            return False
        self.nodes, self.root, self.heading, self.titles = old.nodes, old.root, old.heading, old.titles
        del before[self.name]
        return True

    def move(self, time: float) -> None:
        if self.body.flight is None or self.root is None:
            return
        self.root.position = self.body.at(time)
        self.heading.wxyz = along(self.body.heading(time))


class Obstacles:
    """All obstacles of a scene."""

    def __init__(self, server: viser.ViserServer, setting: Setting, palette: Palette, world: World) -> None:
        self._scene, self._setting, self._palette, self._world = server.scene, setting, palette, world
        self._groups: list[_Group] = []

    def update(self, drawn: Sequence[Drawn], time: float) -> None:
        """Draw them anew, as the flights that there are now have them, where they are at that time [s]."""
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
        """Put those that move where they are at that time [s]."""
        for group in self._groups:
            group.move(time)

    def show(self) -> None:
        """Show those of which a flight is shown."""
        for group in self._groups:
            for node in group.nodes:
                node.visible = group.visible

    def moving(self) -> Iterator[tuple[Body, Rgb]]:
        """Those to be seen that move, each with its colour."""
        for group in self._groups:
            if group.visible and group.body.flight is not None:
                yield group.body, shade(self._colour(group), 0.8)

    def paint(self, palette: Palette, time: float) -> None:
        """The same in other colours."""
        self._palette = palette
        for group in self._groups:
            for node in group.nodes:
                node.remove()
            group.nodes = []
            self._draw(group)
        self.show()
        self.move(time)

    def _grouped(self, flown: Sequence[Drawn]) -> list[_Group]:
        found: list[_Group] = []
        for number, moving in enumerate(self._setting.moving):
            same: list[_Group] = []
            if not flown and not moving:  # where one that moves will be, only a flight can say
                same = [_Group(f"/obstacles/{number}", self._body(number, None))]
            for one in flown:
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
        return body_of(number, values, self._setting.axes, flight)

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
        """Its flight's where flights differ in it."""
        return rgb(group.members[0].style.colour if group.own else self._palette.obstacle)

    def _flat(self, group: _Group, colour: Rgb) -> None:
        """In the plane: a body some way up, the disc that must stay free, its edge dashed."""
        unit, name, body = self._world.frame.unit, group.name, group.body
        height, threshold = 1.2 * unit, self._setting.threshold
        if body.flight is None:
            self._cylinder(f"{name}/core", 0.12 * unit, height, colour, 1.0)
        if body.kind == "box":
            self._box(group, (*body.size[:2], height), height / 2, colour)
        elif body.size[0] > 0:
            self._cylinder(f"{name}/body", body.size[0], height if body.flight is None else 0.4 * unit, colour, 0.45)
        self._cylinder(f"{name}/safety", threshold, 0.02 * height, colour, 0.25)
        ring = shapes.circle(np.array([0.0, 0.0, 0.03 * height]), threshold, dashes=24)
        self._line(f"{name}/ring", ring, rgb(self._palette.ink))

    def _solid(self, group: _Group, colour: Rgb) -> None:
        """In space: the body itself, and what must stay free about its centre as a wire frame."""
        unit, name, body, threshold = self._world.frame.unit, group.name, group.body, self._setting.threshold
        if body.kind == "box":
            self._box(group, body.size, 0.0, colour)
        elif body.kind == "cylinder":
            self._cylinder(f"{name}/body", body.size[0], body.size[1], colour, 0.45, lift=0.0)
            capsule = shapes.capsule(threshold, body.size[1])
            self._mesh(f"{name}/safety", capsule, colour, wireframe=True, opacity=0.25)
            return
        elif body.size[0] > 0.2 * unit:
            self._ball(f"{name}/body", body.size[0], colour, opacity=0.45)
        if body.flight is None and body.reach <= 0.2 * unit:
            self._ball(f"{name}/core", 0.2 * unit, colour)
        if threshold > 0:
            self._ball(f"{name}/safety", threshold, colour, wireframe=True, opacity=0.25)

    def _track(self, group: _Group, colour: Rgb) -> None:
        """What says that it moves: its way in dashes, and a sign that looks along it."""
        name, span, unit = group.name, self._world.frame.span, self._world.frame.unit
        lift = np.array([0.0, 0.0, 0.003 * span if self._setting.planar else 0.0])
        dashes = shapes.dashed(group.body.track + lift, span / 70)
        if len(dashes):
            track = f"/tracks/{name.rpartition('/')[2]}"
            group.nodes.append(self._line(track, dashes, shade(colour, 0.85), 2.5))
        group.heading = self._scene.add_frame(f"{name}/heading", show_axes=False)
        if self._setting.planar:
            # on top of its body, its middle at the centre
            sign = shapes.arrow()
            moved = unit * (sign.vertices - (0.4, 0.0, 0.0)) + (0.0, 0.0, 0.45 * unit)
            self._mesh(f"{name}/heading/sign", shapes.Mesh(moved, sign.faces), shade(colour, 0.7))
        else:
            for part, mesh, share in zip(("body", "rest"), shapes.aircraft(), (0.85, 0.5), strict=True):
                scaled = shapes.Mesh(unit * mesh.vertices, mesh.faces)
                self._mesh(f"{name}/heading/{part}", scaled, shade(colour, share))

    def _label(self, group: _Group) -> None:
        setting, body = self._setting, group.body
        words = []
        if body.flight is not None:
            words.append("intruder" if len(setting.moving) == 1 else f"intruder {body.number + 1}")
        if group.own:
            words += [
                one.style.title if one.style.title.startswith("F") else one.style.title.lower() for one in group.members
            ]
        if group is self._groups[0]:
            words.append(f"{setting.quantity or 'limit'} > {setting.threshold:g} {setting.unit}")
        if not words:
            return
        # Below its safety radius; where flights differ in it and both are near, the second stands above.
        second = "-" in group.name
        off = setting.threshold + (body.size[1] / 2 if body.kind == "cylinder" else 0.0)
        off = off if second else -off
        self._scene.add_label(
            f"{group.name}/label",
            ", ".join(words),
            position=(0.0, off, 0.0) if setting.planar else (0.0, 0.0, off),
            anchor=anchor_of(group.members, "bottom" if second else "top"),
            font_screen_scale=0.8,
        )

    def _line(self, name: str, segments: Any, colour: Rgb, width: float = LINE) -> Any:
        return self._scene.add_line_segments(
            name, segments.astype(np.float32), colour, thickness=width, thickness_units="screen"
        )

    def _ball(
        self, name: str, radius: float, colour: Rgb, opacity: float | None = None, wireframe: bool = False
    ) -> None:
        self._scene.add_icosphere(
            name, radius, colour, opacity=opacity, wireframe=wireframe, cast_shadow=False, receive_shadow=False
        )

    def _box(self, group: _Group, size: tuple[float, ...], lift: float, colour: Rgb) -> None:
        length, width, height = size
        self._scene.add_box(
            f"{group.name}/body",
            colour,
            (length, width, height),
            opacity=0.45,
            cast_shadow=False,
            receive_shadow=False,
            position=(0.0, 0.0, lift),
            wxyz=group.body.turn,
        )

    def _mesh(
        self, name: str, mesh: shapes.Mesh, colour: Rgb, opacity: float | None = None, wireframe: bool = False
    ) -> None:
        self._scene.add_mesh_simple(
            name,
            mesh.vertices.astype(np.float32),
            mesh.faces.astype(np.uint32),
            color=colour,
            opacity=opacity,
            wireframe=wireframe,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _cylinder(
        self, name: str, radius: float, height: float, colour: Rgb, opacity: float, lift: float | None = None
    ) -> None:
        self._scene.add_cylinder(
            name,
            radius=radius,
            height=height,
            color=colour,
            opacity=opacity if opacity < 1 else None,
            radial_segments=48,
            cast_shadow=False,
            receive_shadow=False,
            position=(0.0, 0.0, height / 2 if lift is None else lift),
        )


def _longer(one: Body, other: Body) -> bool:
    """Whether one is known for longer than the other."""
    if one.flight is None or other.flight is None:
        return False
    return bool(one.flight.time[-1] > other.flight.time[-1])
