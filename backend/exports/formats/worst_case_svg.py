"""The worst case and the nominal flight from above as a picture, for a summary of a CI job."""

from __future__ import annotations

from backend.exports.format import Format, whole, words
from backend.reports import picture

export = Format(
    file="worst-case.svg",
    order=8,
    media_type="image/svg+xml",
    words=words(
        "Worst case, SVG",
        "Flights from above around the closest approach of the worst one",
        (
            "Worst case, SVG",
            "Nominal and worst case where the simulator declares positions, from above or from the side",
        ),
    ),
    made=lambda engine, run_id: whole(engine, run_id, picture.picture),
    offered=lambda stored: None if stored.simulated and not stored.drawn else "",
    needs="flights",
)
