"""Whoever may only read starts no simulation through a 3D view: neither a viewer nor a token of that scope."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

import httpx
import pytest

from backend.db import access
from backend.scenes.base.schemas import LayersChange
from tests.given.finished_runs import finish
from tests.given.joined_users import joined
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, steer, viewing

SIMULATED = {"sampled", "field"}
CHANGES = ({"what_if": {"vehicle.m": 5.1}}, *({"layers": {layer: True}} for layer in sorted(SIMULATED)))


def reading(service: Service, admin: httpx.Client, how: str) -> AbstractContextManager[httpx.Client]:
    if how == "viewer":
        return as_viewer(service, admin)
    with service.engine.begin() as writer:
        token = access.create_token(writer, "reads", scope="read")
    return service.visitor(Authorization=f"Bearer {token}")


@contextmanager
def as_viewer(service: Service, admin: httpx.Client) -> Iterator[httpx.Client]:
    with joined(service, admin, "viewer") as (_, client):
        yield client


@pytest.mark.parametrize(("how", "kind"), [("viewer", "role-too-low"), ("token", "scope-too-narrow")])
def test_a_change_of_a_view_that_is_simulated_is_refused_as_a_flight_is(
    service: Service, client: httpx.Client, how: str, kind: str
) -> None:
    run = submit(client)
    with reading(service, client, how) as reader:
        flight = problem(reader.post(f"/api/v1/runs/{run}/flights", json={"parameters": {}}), 403, kind)
        for change in CHANGES:
            refused = problem(reader.patch(f"/api/v1/runs/{run}/views/{KEY}", json=change), 403, kind)
            assert refused["detail"] == flight["detail"]
            problem(client.patch(f"/api/v1/runs/{run}/views/{KEY}", json=change), 404, "no-such-view")


def test_what_a_viewer_changes_of_a_view_simulates_nothing(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    layers = {name: True for name in LayersChange.model_fields if name not in {*SIMULATED, "trail"}}
    with joined(service, client, "viewer") as (_, viewer), viewing(service, viewer, f"/view/{run}/key/{KEY}"):
        shown = steer(viewer, run, layers=layers, flight="nominal", time=1.0, camera="top", panel=True)
        assert steer(viewer, run, layers=dict.fromkeys(SIMULATED, False), closest=True)["layers"] == shown["layers"]
    assert service.app.state.live._child is None
    assert service.app.state.cases._child is None
