"""The units that parameters and signals may have: symbols of the SI and a few others, as products and quotients."""

from __future__ import annotations

import re

from worker.running.examination.mistake import meant

_SI = "m s kg A K mol cd rad sr N Pa J W V C F H T Hz ohm S Wb lm lx"
_SCALED = "g mm cm km um µm nm ms us ns mg kN mN kPa MPa hPa kJ MJ kW MW mW mV kV mA kHz MHz GHz"
_OTHERS = "deg ° °C l t bar min h d % ppm px rpm kn ft mAh Ah"
SYMBOLS = frozenset(" ".join((_SI, _SCALED, _OTHERS)).split())
POWER = re.compile(r"\^?-?[\dn.]+$")
BRACKETED = re.compile(r"\^\([^()]*\)")
SPLIT = re.compile(r"[\s*/()·]+")
WORDS = {
    "metre": "m", "metres": "m", "meter": "m", "meters": "m", "second": "s", "seconds": "s", "sec": "s",
    "radian": "rad", "radians": "rad",
    "degree": "deg", "degrees": "deg", "kilogram": "kg", "kilograms": "kg", "newton": "N",
    "newtons": "N", "hertz": "Hz", "mps": "m/s", "kmh": "km/h", "kph": "km/h", "mph": "m/s", "volt": "V", "volts": "V",
}  # fmt: skip


def unknown(unit: str) -> str:
    """Advice for a unit that is not known; empty if it is known. "" and "-" are numbers without a unit."""
    if unit in ("", "-", "1"):
        return ""
    for part in filter(None, SPLIT.split(BRACKETED.sub("", unit))):
        symbol = POWER.sub("", part)
        if symbol and symbol not in SYMBOLS and part not in SYMBOLS:
            if symbol.lower() in WORDS:
                return f"write {WORDS[symbol.lower()]!r}"
            return meant(symbol, sorted(SYMBOLS), "use symbols of the SI such as m, m/s, kg m2, rad/s, 1/s")
    return ""
