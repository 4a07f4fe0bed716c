"""The 3D view of a simulator draws what its trace declares, and nothing else."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from backend.scenes.base.flight import Flight, from_live
from campaigns.stored.records import Trace
from tests.given.declared_traces import SCENE, declared, trace
from tests.given.finished_runs import turned
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.viewer_clients import KEY, Panel, frames_until, steer, viewing


def drawn(stored: Trace) -> Flight | None:
    data = {column.name: stored.data[:, k] for k, column in enumerate(stored.columns)}
    columns = [column.model_dump() for column in stored.columns]
    return from_live({"columns": columns, "data": data, "meta": stored.meta.model_dump(), "identity": {}})


def scene(frame: str = "z_up", **vehicle: Any) -> dict[str, Any]:
    return {"frame": frame, "vehicle": {"position": ["x", 0, "z"]} | vehicle}


def test_what_is_declared_is_drawn_at_its_positions(bare: Service) -> None:
    with bare.signed_in() as client:
        run = declared(bare, client, lambda name: trace(name, speed=1.0 if name == "nominal" else 0.5))
        with viewing(bare, client, f"/view/{run}/t/1.0/key/{KEY}") as connection:
            panel = Panel(connection, last="Search")
            moving = ("/flights/nominal/vehicle", "/flights/worst/vehicle", "/obstacles/1")
            for time in (4.0, 12.0):
                places = panel.places(partial(steer, client, run, time=time), *moving)
                assert places[moving[0]]["position"] == pytest.approx((time, 0, 100 - 5 * time))
                assert places[moving[1]]["position"] == pytest.approx((0.5 * time, 0, 100 - 5 * time))
                assert places[moving[2]]["position"] == pytest.approx((-time, 5, 20))
            state = steer(client, run, time=99.0)
            assert (state["horizon"], state["time"], state["flight"]) == (20.0, 20.0, "F1")
            assert problem(steering(client, run, {"layers": {"field": True}}), 422)["type"].endswith("parameter")
            assert problem(steering(client, run, {"what_if": {"simulator.wind": 1.0}}), 422)


def steering(client: Any, run: str, change: dict[str, Any]) -> Any:
    return client.patch(f"/api/v1/runs/{run}/views/{KEY}", json=change)


def test_names_are_shown_and_no_limit_is_claimed(bare: Service) -> None:
    with bare.signed_in() as client:
        run = declared(bare, client)
        with viewing(bare, client, f"/view/{run}/") as connection:
            received = frames_until(connection, b"Search")
    for text in (b"mast", b"bird", b"/obstacles/0/body", b"d_min"):
        assert text in received
    for text in (b"/safety", b"d_min > 1", b"intruder", b"/north/label", b"Field"):
        assert text not in received


@pytest.mark.parametrize("given", [None, scene(position=["gone", 0, "z"])])
def test_without_positions_the_view_is_refused_with_what_to_declare(bare: Service, given: Any) -> None:
    with bare.signed_in() as client:
        run = declared(bare, client, lambda name: trace(name, given))
        if given is None:
            assert " `scene`" in problem(client.get(f"/view/{run}/"), 404)["detail"]
        else:  # a declaration that does not fit its trace is no crash
            with viewing(bare, client, f"/view/{run}/") as connection:
                assert b"No case is stored yet." in frames_until(connection, b"Search", b"No case")
        recorded = problem(client.get(f"/api/v1/runs/{run}/exports/flight-nominal.html"), 404)["detail"]
        why = "Declare them under `scene`" if given is None else "fewer than two rows with all positions"
        assert why in recorded
        offered = [file["href"] for file in client.get(f"/api/v1/runs/{run}/exports").json()]
        assert any("flight-" in href for href in offered) == (given is not None)


def test_a_vehicle_without_an_attitude_points_along_its_motion() -> None:
    found = drawn(trace("nominal", scene(), x=np.linspace(0, 40.0, 401), z=np.full(401, 7.0)))
    assert found is not None
    assert turned(found.at(3.0)[1], np.array([1.0, 0, 0])) == pytest.approx((1, 0, 0))
    still = drawn(trace("nominal", scene(), x=np.zeros(401), z=np.zeros(401)))
    assert still is not None
    assert still.at(3.0)[1] == pytest.approx((1, 0, 0, 0))


@pytest.mark.parametrize(
    ("frame", "attitude", "forward", "up"),
    [
        ("z_up", {"angles": [0, 0, "deg"]}, (0, 1, 0), (0, 0, 1)),
        ("z_up", {"angles": [0, "deg", 0]}, (0, 0, -1), (1, 0, 0)),
        ("z_up", {"quaternion": ["q", 0, 0, "q"]}, (0, 1, 0), (0, 0, 1)),
        ("z_down", {"angles": [0, 0, "deg"]}, (1, 0, 0), (0, 0, 1)),
        ("z_down", {"angles": [0, "deg", 0]}, (0, 0, 1), (0, -1, 0)),
        ("z_down", {"quaternion": ["q", 0, "q", 0]}, (0, 0, 1), (0, -1, 0)),
    ],
)
def test_attitudes_follow_the_stated_convention(frame: str, attitude: Any, forward: Any, up: Any) -> None:
    """Right-handed, about z, then the new y, then the new x; where z is down, x ahead is up on the page."""
    found = drawn(trace("nominal", scene(frame, **attitude)))
    assert found is not None
    turn = found.at(3.0)[1]
    assert turned(turn, np.array([1.0, 0, 0])) == pytest.approx(forward, abs=1e-9)
    assert turned(turn, np.array([0, 0, 1.0])) == pytest.approx(up, abs=1e-9)


def test_z_down_is_drawn_upright() -> None:
    found = drawn(trace("nominal", scene("z_down", position=["x", 3, "z"])))
    assert found is not None
    assert found.at(4.0)[0] == pytest.approx((3, 4, -80))


def test_rows_without_a_position_are_left_out() -> None:
    gone = np.where(np.arange(401) % 2 == 0, np.nan, -1.0)
    for changed in ({"bird": gone}, {"x": gone}, {"z": np.where(np.isnan(gone), 1e300, 0.0)}):
        found = drawn(trace("nominal", **changed))
        assert found is not None
        assert len(found.time) <= 200
        assert np.isfinite(found.position).all()
    assert drawn(trace("nominal", x=np.full(401, np.nan))) is None
    zero = scene(quaternion=["q", "q", "q", "q"])
    assert drawn(trace("nominal", zero, q=np.zeros(401))) is None


def test_turns_between_rows_are_short() -> None:
    """Quaternions of opposite sign are the same attitude."""
    sign = np.where(np.arange(401) % 2 == 0, 1.0, -1.0) * np.sqrt(0.5)
    found = drawn(trace("nominal", scene(quaternion=["q", 0, 0, "q"]), q=sign))
    assert found is not None
    for time in (1.0, 1.02, 1.025, 1.03):
        assert turned(found.at(time)[1], np.array([1.0, 0, 0])) == pytest.approx((0, 1, 0), abs=1e-9)


def test_in_the_plane_obstacles_have_no_disc_that_must_stay_clear(bare: Service) -> None:
    flat = {"frame": "z_up", "vehicle": {"position": ["x", "z"], "angles": [0, 0, "deg"]}}
    flat["obstacles"] = [{"shape": "box", "position": [3, 4], "size": [1, 2], "angle": 0.5}]
    with bare.signed_in() as client:
        run = declared(bare, client, lambda name: trace(name, flat), found=False)
        with viewing(bare, client, f"/view/{run}/") as connection:
            received = frames_until(connection, b"Search")
    assert b"/obstacles/0/body" in received
    assert b"/obstacles/0/ring" not in received


def test_the_declaration_is_part_of_the_stored_trace(bare: Service) -> None:
    with bare.signed_in() as client:
        run = declared(bare, client)
        stored = client.get(f"/api/v1/runs/{run}/traces/nominal").json()["meta"]["scene"]
    assert stored["frame"] == SCENE["frame"]
    assert stored["bodies"][0]["position"] == ["bird", 5, 20]
