"""The stored nominal flights of the shipped campaigns are those of today's campaigns and code."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from campaigns import Campaign, library, load_file
from campaigns.results import drawn as results
from campaigns.results.drawn import FILE, FLIGHTS, DrawnFlight, library_flights
from tools import library_flights as tool
from worker.running.opening import opened

AGAIN = "run `make library-flights`"
QUICK = "unicycle_static"


@pytest.fixture(scope="module")
def campaigns() -> dict[str, Campaign]:
    return {name: load_file(path) for name, path in library().items()}


def test_every_campaign_has_the_flight_of_its_text_and_code(campaigns: dict[str, Campaign]) -> None:
    stored = {name: (flight.digest, flight.code) for name, flight in library_flights().items()}
    now = {
        name: (one.digest, tool.code_of(opened.flights(one, compiled=False, lanes=1)))
        for name, one in campaigns.items()
    }
    assert stored == now, AGAIN
    assert FILE.read_text(encoding="utf-8") == tool.written(library_flights()), AGAIN


def test_a_flight_simulated_again_is_the_stored_one(campaigns: dict[str, Campaign]) -> None:
    same(tool.drawn(campaigns[QUICK]), library_flights()[QUICK])


@pytest.mark.nightly
@pytest.mark.parametrize("name", [name for name in library() if name != QUICK])
def test_all_flights_simulated_again_are_the_stored_ones(campaigns: dict[str, Campaign], name: str) -> None:
    same(tool.drawn(campaigns[name]), library_flights()[name])


def same(made: DrawnFlight, stored: DrawnFlight) -> None:
    """Equal, but for the last digit that is stored."""
    assert made.model_copy(update={"x": [], "y": [], "tracks": [], "value": 0.0, "closest": None}) == stored.model_copy(
        update={"x": [], "y": [], "tracks": [], "value": 0.0, "closest": None}
    ), AGAIN
    assert made.value == pytest.approx(stored.value, rel=1e-8), AGAIN
    extent = max(map(math.dist, zip(made.x, made.y, strict=True), [(made.x[0], made.y[0])] * len(made.x)))
    columns = [(made.x, stored.x), (made.y, stored.y)]
    for one, other in zip(made.tracks, stored.tracks, strict=True):
        columns += [(one.x, other.x), (one.y, other.y)]
    for one_column, other_column in columns:
        assert one_column == pytest.approx(other_column, abs=2e-4 * extent), AGAIN


def test_flights_are_whole_and_small(campaigns: dict[str, Campaign]) -> None:
    for name, flight in library_flights().items():
        rows = {len(flight.x), len(flight.y), *(len(t.x) for t in flight.tracks), *(len(t.y) for t in flight.tracks)}
        assert len(rows) == 1, name
        assert 1 < rows.pop() <= tool.ROWS + 1, name
        assert (flight.status == "ok") == (flight.value is not None) == (flight.reason == ""), name
        obstacles = len(campaigns[name].given_scenario.obstacles)
        assert all(0 <= track.obstacle < obstacles for track in flight.tracks), name
    assert FILE.stat().st_size < 250_000


def test_an_edit_of_what_a_loop_reaches_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """And an edit of what it does not reach is not: a new component does not make all flights stale."""
    flights = opened.flights(load_file(library()[QUICK]), compiled=False, lanes=1)
    before = tool.code_of(flights)
    known = tool.identity.loaded()
    for module, differs in (
        ("worker.engine.components.vehicles.unicycle", True),
        ("worker.engine.components.avoiders.orca", False),
    ):
        edited = {**known, module: known[module]._replace(digest="0" * 16)}
        monkeypatch.setattr(tool.identity, "loaded", lambda edited=edited: edited)
        assert (tool.code_of(flights) != before) == differs, module


def test_a_flight_that_fails_is_stored_with_its_reason_up_to_there() -> None:
    """A wall of force: the robot starts inside the required distance."""
    document = load_file(library()[QUICK]).document()
    document["scenario"]["obstacles"][0]["parameters"] |= {"position.x": 0.0, "position.y": 0.0}
    flight = tool.drawn(Campaign.model_validate(document))
    assert flight.status == "excluded"
    assert " 0.5 m" in flight.reason
    assert flight.value is None
    assert FLIGHTS.validate_json(tool.written({"x": flight})) == {"x": flight}


@pytest.mark.parametrize("damage", ["", "{", '{"unicycle_static": {"x": "no numbers"}}', None])
def test_a_damaged_file_costs_the_pictures_and_nothing_else(
    damage: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "flights.json"
    if damage is not None:
        file.write_text(damage, encoding="utf-8")
    monkeypatch.setattr(results, "FILE", file)
    assert library_flights.__wrapped__() == {}
    assert str(file) in caplog.text
