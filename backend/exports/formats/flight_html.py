"""A stored flight and the nominal flight in 3D as one HTML file with a play bar, which works offline.

It shows its parameters at full precision, the criterion, the digests and the versions. `{label}` is F1 or nominal.
"""

from __future__ import annotations

from fastapi import Request
from fastapi.responses import Response

from backend.exports.format import Format, Stored, Words
from backend.scenes.recordings import pages as recordings

TEXT = "A recording with a play bar; one file that works offline"


def _offered(stored: Stored) -> str | None:
    """The worst stored flight, or case of a simulator that can be drawn; the others have similar addresses."""
    if stored.simulated and not stored.drawn:
        return None
    return next((name for name in stored.drawn if name != "nominal"), "nominal")


def _words(stored: Stored) -> Words:
    label, one = _offered(stored), "case" if stored.simulated else "flight"
    title = f"Nominal {one}" if label == "nominal" else f"{one.capitalize()} {label}"
    return Words(f"{title} in 3D, HTML", TEXT)


async def _answer(request: Request, run: str, label: str, dark: bool) -> Response:
    return await recordings.answer(request, run, label, dark=dark, how="attachment")


export = Format(
    file="flight-{label}.html",
    order=10,
    media_type="text/html",
    words=_words,
    answer=_answer,
    offered=_offered,
    needs="flights",
)
