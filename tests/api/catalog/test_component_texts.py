"""Texts of installed components reach the pages completely: equations, symbols, units, limits, sources."""

from __future__ import annotations

import json

from tests.given.service import Service
from worker.running.catalogue.installed import catalogue


def test_components_with_their_equations(bare: Service) -> None:
    printed = catalogue().model_dump_json()
    bare.publish(json.loads(printed))
    with bare.signed_in() as client:
        told = {(c["role"], c["name"]): c for c in client.get("/api/v1/components").json()["components"]}
    unicycle = told["vehicle", "unicycle"]
    for part in ("dv/dt = F / m", "Source: Srikanthakumar"):
        assert part in unicycle["text"]
    mass = next(p for p in unicycle["parameters"] if p["name"] == "m")
    assert (mass["symbol"], mass["unit"]) == ("m", "kg")
    assert mass["text"]
    pioneer = told["vehicle", "pioneer_3dx"]
    assert {p["unit"] for p in pioneer["parameters"]} >= {"kg", "m", "kg m2"}
    assert [c["text"] for c in told.values()] == [c["text"] for c in json.loads(printed)["components"]]
