"""The avoider's field in a viewer: computed by the simulation process, drawn, updated with the time."""

from __future__ import annotations

from tests.given.finished_runs import Work, flight
from tests.given.service import Service
from tests.given.shipped_runs import shipped
from tests.given.viewer_clients import KEY, frames_until, steer, viewing


def test_the_field_is_shown_for_the_time_shown(simulating: Service) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "unicycle_static")
        work = Work(simulating)
        with viewing(simulating, client, f"/view/{run}/t/2.0/key/{KEY}") as connection:
            steer(client, run, layers={"field": True})
            frames_until(connection, b"There is no flight yet; its field cannot be shown")
            work.nominal(flight("nominal"))
            drawn = frames_until(
                connection,
                b"/field/slice/plane",
                b"/field/slice/arrows",
                b"demands over the plane, at t = 2.00 s of Nominal",
                seconds=120,
            )
            assert b"Force [N]" in drawn
            assert b"\x89PNG" in drawn
            steer(client, run, time=4.0)
            frames_until(connection, b"at t = 4.00 s of Nominal")
            steer(client, run, layers={"field": False})
            frames_until(connection, b"SetSceneNodeVisibility", b"/field")


def test_an_unavailable_field_gives_its_reason(bare: Service) -> None:
    with bare.signed_in() as client:
        run = shipped(bare, client, "unicycle_static")
        Work(bare).nominal(flight("nominal"))
        bare.app.state.live.close()
        with viewing(bare, client, f"/view/{run}/t/2.0/key/{KEY}") as connection:
            steer(client, run, layers={"field": True})
            frames_until(connection, b"the service is stopping")
