"""Places the labels of a scene so that none covers another.

viser draws a label at a position in space, at a constant size on the screen. Here each label gets a rectangle as the
camera sees it; where two would overlap, the later one is anchored at another corner, or moved in the plane of the
screen until it is free. A placement is retained as long as it is free, so that labels do not jump.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from backend.scenes.base.axes import Floats, unit
from backend.scenes.base.part import Part
from backend.scenes.drawing.cameras import ASPECT, FIELD_OF_VIEW

Anchor = Literal[
    "top-left",
    "top-center",
    "top-right",
    "center-left",
    "center-right",
    "bottom-left",
    "bottom-center",
    "bottom-right",
]

HEIGHT = 560.0
"""Height of the window until a browser reports its own [px]."""
EM = 12.0
"""Font size of a label of scale 1, in any window [px]."""
WIDE, HIGH = 0.6, 1.3
"""Width of a character and height of a line in a system font, rounded up [em]."""
PADDING = 0.2
"""Between the text and the edge of its ground, as a fraction of the line height."""
AIR = 2.0
"""Between labels that are one line apart, besides their padding [px]."""
ROWS = 8
"""How many lines a label is moved at most."""

ANCHORS: tuple[Anchor, ...] = (
    *("top-left", "top-right", "bottom-left", "bottom-right"),
    *("top-center", "bottom-center", "center-left", "center-right"),
)


@dataclass(frozen=True)
class View:
    eye: Floats
    target: Floats
    width: float = ASPECT * HEIGHT
    height: float = HEIGHT

    @cached_property  # asked for every possible place of every label
    def axes(self) -> tuple[Floats, Floats, Floats]:
        """Unit vectors to the right, up, and ahead of the camera, which is never rolled."""
        ahead = unit(self.target - self.eye, (0.0, 1.0, 0.0))
        right = np.cross(ahead, (0.0, 0.0, 1.0))
        right = unit(right) if np.linalg.norm(right) > 1e-9 else np.array([1.0, 0.0, 0.0])
        return right, np.cross(right, ahead), ahead

    @property
    def scale(self) -> float:
        """Pixels per metre at a distance of one metre."""
        return float(self.height / (2.0 * np.tan(FIELD_OF_VIEW / 2.0)))

    def like(self, other: View) -> bool:
        """Whether labels look the same from both."""
        near = 1e-3 * float(np.linalg.norm(self.eye - self.target))
        same = np.linalg.norm(self.eye - other.eye) <= near and np.linalg.norm(self.target - other.target) <= near
        return bool(same) and (self.width, self.height) == (other.width, other.height)

    def pixel(self, place: Floats) -> tuple[float, float, float]:
        """Position in the window, from its top left corner [px], and the depth [m]."""
        right, up, ahead = self.axes
        away = place - self.eye
        depth = float(away @ ahead)
        scale = self.scale / max(depth, 1e-9)
        return self.width / 2 + scale * float(away @ right), self.height / 2 - scale * float(away @ up), depth

    def moved(self, place: Floats, across: float, down: float) -> Floats:
        """The position that is seen so many pixels to the right and below, at the same depth."""
        right, up, ahead = self.axes
        metres = float((place - self.eye) @ ahead) / self.scale
        return place + metres * (across * right - down * up)


@dataclass(frozen=True, eq=False)
class Label:
    """A label as it should be: the earlier ones of a scene are placed first."""

    name: str
    text: str
    place: Floats
    """In the scene [m]."""
    anchor: Anchor
    """The corner of the text that is at the place."""
    size: float
    """viser's `font_screen_scale`."""
    fixed: bool = False
    """It would be wrong anywhere else, as the mark of a scale: without room it is hidden."""


@dataclass(frozen=True, eq=False)
class Tag:
    """A label in the scene: how it should be, its viser node, and where the node's parent is [m]."""

    label: Label
    node: Any
    origin: Floats


@dataclass(frozen=True, eq=False)
class Spot:
    place: Floats
    anchor: Anchor
    wanted: Floats
    """Where it should be."""

    def after(self, place: Floats) -> Spot:
        """The position with the same offset from `place`, where the label should be now."""
        return Spot(place + (self.place - self.wanted), self.anchor, place)


@dataclass(frozen=True)
class Box:
    """A rectangle in the window [px]."""

    left: float
    top: float
    right: float
    bottom: float

    def meets(self, other: Box) -> bool:
        across = self.left < other.right and other.left < self.right
        return across and self.top < other.bottom and other.top < self.bottom

    def within(self, view: View) -> bool:
        return self.left >= 0 and self.top >= 0 and self.right <= view.width and self.bottom <= view.height


def box(text: str, size: float, anchor: Anchor, at: tuple[float, float]) -> Box:
    """The ground of a label whose anchor is at this pixel."""
    em = EM * size
    lines = text.split("\n")
    line = HIGH * em
    width = WIDE * em * max(map(len, lines)) + PADDING * line
    height = line * len(lines) + PADDING * line
    vertical, horizontal = anchor.split("-")
    left = at[0] - width * {"left": 0.0, "center": 0.5, "right": 1.0}[horizontal]
    top = at[1] - height * {"top": 0.0, "center": 0.5, "bottom": 1.0}[vertical]
    return Box(left, top, left + width, top + height)


def arranged(
    labels: Iterable[Label], view: View, before: Mapping[str, Spot | None] | None = None
) -> dict[str, Spot | None]:
    """The position of each label, by its name: None for a fixed one without room. Labels behind the camera are not
    moved.

    before: the present placement, retained as far as it is free.
    """
    spots: dict[str, Spot | None] = {}
    taken: list[Box] = []
    for label in labels:
        spot: Spot | None = Spot(label.place, label.anchor, label.place)
        if view.pixel(label.place)[2] > 0.0 and label.text:
            spot, place = _free(label, view, taken, (before or {}).get(label.name))
            taken += [place] if spot else []
        spots[label.name] = spot
    return spots


class Labels(Part):
    def __init__(self, tags: Callable[[float], Iterable[Tag]], view: Callable[[], View]) -> None:
        """tags: the visible labels at a time [s], the first ones having precedence; view: the camera now."""
        self._tags, self._view = tags, view
        self._spots: dict[str, Spot | None] = {}
        self._time = 0.0
        self._seen_from: View | None = None

    def moved(self, time: float) -> None:
        self._time = time
        self.arrange()

    def changed(self) -> None:
        self.arrange()

    @property
    def due(self) -> bool:
        """Whether the camera or the window has changed since the labels were placed."""
        return self._seen_from is None or not self._seen_from.like(self._view())

    def arrange(self) -> None:
        """Place all labels; sends only what changed."""
        view = self._seen_from = self._view()
        tags = sorted(self._tags(self._time), key=lambda tag: not tag.label.fixed)
        self._spots = arranged([tag.label for tag in tags], view, self._spots)
        for tag in tags:
            put(tag, self._spots[tag.label.name])


def _seen(label: Label, spot: Spot, view: View) -> Box:
    x, y, _ = view.pixel(spot.place)
    return box(label.text, label.size, spot.anchor, (x, y))


def _free(label: Label, view: View, taken: Sequence[Box], before: Spot | None) -> tuple[Spot | None, Box]:
    """The first of the possible spots that is free and in the window; else the first that is free."""
    wanted = Spot(label.place, label.anchor, label.place)
    first = _seen(label, wanted, view)
    if label.fixed:
        return None if any(first.meets(other) for other in taken) else wanted, first
    beside: tuple[Spot, Box] | None = None
    for spot in _possible(label, view, before):
        place = _seen(label, spot, view)
        if any(place.meets(other) for other in taken):
            continue
        if place.within(view):
            return spot, place
        beside = beside or (spot, place)
    return beside or (wanted, first)


def _possible(label: Label, view: View, before: Spot | None) -> Iterator[Spot]:
    """Yield positions to try: the wanted one, the present one, other corners, then moved by whole lines, nearest
    first."""
    wanted = Spot(label.place, label.anchor, label.place)
    yield wanted
    if before is not None:
        yield before.after(label.place)
    others = [anchor for anchor in ANCHORS if anchor != label.anchor]
    yield from (replace(wanted, anchor=anchor) for anchor in others)
    line = HIGH * EM * label.size * (1.0 + PADDING) + AIR
    for row in range(1, ROWS + 1):
        for side in (-1, 1):
            place = view.moved(label.place, 0.0, side * row * line)
            yield from (Spot(place, anchor, label.place) for anchor in (label.anchor, *others))


def put(tag: Tag, spot: Spot | None) -> None:
    node = tag.node
    if node.visible != (spot is not None):
        node.visible = spot is not None
    if spot is None:
        return
    place = spot.place - tag.origin
    if node.anchor != spot.anchor:
        node.anchor = spot.anchor
    if not np.allclose(node.position, place, rtol=0.0, atol=1e-9):
        node.position = place
