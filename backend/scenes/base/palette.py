"""The colours of the pages for the scene (Okabe and Ito, "Color Universal Design")."""

from __future__ import annotations

from dataclasses import dataclass

from campaigns.looks import MethodLook

Rgb = tuple[int, int, int]


def rgb(colour: str) -> Rgb:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def shade(colour: Rgb, fraction: float) -> Rgb:
    red, green, blue = (int(fraction * part) for part in colour)
    return red, green, blue


def linear(colour: Rgb) -> Rgb:
    """Convert sRGB to linear light (IEC 61966-2-1): viser interprets colours of single points and segments as linear,
    but the colour of a whole node as sRGB."""

    def part(byte: int) -> int:
        share = byte / 255
        return round(255 * (share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4))

    return part(colour[0]), part(colour[1]), part(colour[2])


@dataclass(frozen=True)
class Palette:
    """One theme: colours of flights by role, of methods as they declare them."""

    dark: bool

    background: str
    grid: str
    section: str
    ink: str
    soft: str
    nominal: str
    worst: str
    what_if: str
    obstacle: str
    goal: str
    relative: str
    sampled: str

    def method(self, look: MethodLook | None) -> str:
        if look is None:
            return self.nominal
        return look.dark if self.dark else look.colour


_COLOURS = {
    "background": ("#eef1f4", "#10151a"),
    "grid": ("#dce1e7", "#1f2831"),
    "section": ("#c3ccd6", "#2f3b47"),
    "ink": ("#15202b", "#e7ecf2"),
    "soft": ("#5d6a7b", "#8f9cab"),
    "nominal": ("#77838f", "#94a1ae"),
    "worst": ("#d55e00", "#e8702a"),
    "what_if": ("#0072b2", "#3f9bdb"),
    "obstacle": ("#56b4e9", "#56b4e9"),
    "goal": ("#009e73", "#17b88a"),
    "relative": ("#aa3377", "#e07fb5"),
    "sampled": ("#b4bdc8", "#4a5866"),
}
"""Light and dark."""

LIGHT = Palette(dark=False, **{name: light for name, (light, _) in _COLOURS.items()})
DARK = Palette(dark=True, **{name: dark for name, (_, dark) in _COLOURS.items()})
