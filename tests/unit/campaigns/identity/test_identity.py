"""What an identity covers: a change of any part of it is named and is another digest, whatever the part."""

from __future__ import annotations

from typing import Any

import pytest

from backend.runs.waiting import UNIDENTIFIED
from campaigns.identity.code import model_of
from campaigns.identity.identity import (
    UNREAD,
    UNSTORED,
    changes,
    differences,
    identity_of,
    may_equal,
    same,
    unsound,
)
from campaigns.stored.records import Begun
from campaigns.versions import OtherCode, Processor, Versions
from tests.given.case_campaigns import campaign
from worker.running.runs import begun, identity, provenance, sources

VERSIONS = Versions(
    code="a" * 64,
    model="b" * 64,
    loop="c" * 16,
    simulator="d" * 64,
    components={"my_robot.py": "1", "my_way.py": "2"},
    packages={"numpy": "2.4.6", "scipy": "1.17.1"},
    python="3.11.7",
)
PARTS: list[tuple[str, dict[str, Any], str]] = [
    ("engine", {"code": "e" * 64, "model": "f" * 64}, "the code digest was aaaaaaaaaaaa, here it is eeeeeeeeeeee"),
    ("compiled loop", {"loop": "0" * 16}, "the loop digest was cccccccccccc, here it is 000000000000"),
    ("simulators/pendulum", {"simulator": "0" * 64}, "simulators/pendulum has changed"),
    (
        "components/my_way.py",
        {"components": {"my_robot.py": "1", "my_way.py": "3"}},
        "components/my_way.py has changed",
    ),
    ("components/my_way.py", {"components": {"my_robot.py": "1"}}, "components/my_way.py is gone"),
    ("components/a.py", {"components": {**VERSIONS.components, "a.py": "1"}}, "components/a.py is new"),
    ("numpy", {"packages": {"numpy": "2.5.0", "scipy": "1.17.1"}}, "numpy was 2.4.6, here it is 2.5.0"),
    ("Python", {"python": "3.12.1"}, "Python was 3.11.7, here it is 3.12.1"),
]


@pytest.mark.parametrize(("name", "change", "text"), PARTS)
def test_a_change_of_any_part_is_named_and_another_digest(name: str, change: dict[str, Any], text: str) -> None:
    then = identity_of(VERSIONS, "pendulum")
    now = identity_of(VERSIONS.model_copy(update=change), "pendulum")
    assert [one.name for one in changes(then, now)] == [name]
    assert differences(then, now) == [text]
    assert then.digest != now.digest
    assert not same(then, now)
    assert unsound(then, now)
    assert may_equal(then, now) == (name in ("compiled loop", "numpy", "Python")), "another model of what is simulated"
    assert same(then, then)


@pytest.mark.parametrize("stored", [None, f"{UNREAD}0123"])
def test_what_cannot_be_read_exactly_is_never_the_same(stored: str | None) -> None:
    one = identity_of(VERSIONS.model_copy(update={"simulator": stored}), "pendulum")
    assert (one.digest, one.unidentified) == (None, ("simulators/pendulum",))
    assert not same(one, one)
    assert differences(one, one) == unsound(one, one) == [f"simulators/pendulum {UNIDENTIFIED}"]
    assert may_equal(one, one), "a violation by it stands"
    assert not same(UNSTORED, UNSTORED)


def test_methods_and_stages_choose_points_only() -> None:
    then = identity_of(VERSIONS, "pendulum")
    now = identity_of(VERSIONS.model_copy(update={"code": "e" * 64}), "pendulum")
    assert unsound(then, now) == []
    assert may_equal(then, now)


def test_objectives_make_no_other_model_and_are_not_carried_on_by_other_code() -> None:
    plain, several = campaign(), campaign(objectives=[{"component": "goal_miss"}])
    parts = identity.code_parts()
    changed = parts.model_copy(update={"components": parts.components | {"criterion goal_miss": "0" * 64}})
    models = [model_of(asked, known) for asked, known in ((plain, parts), (several, parts), (several, changed))]
    alone, both, others = (
        identity_of(VERSIONS.model_copy(update={"code": str(k) * 64, "model": model}), "pendulum")
        for k, model in enumerate(models)
    )
    assert may_equal(alone, both)
    assert may_equal(both, others)
    assert unsound(both, others), "what they measured beside the criterion may differ"


def test_a_run_with_own_components_is_continued_by_the_code_that_began_it(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = campaign()
    monkeypatch.setattr(sources, "own", lambda modules: {"my_robot.py": "1"})
    versions = Versions(code=identity.code(asked).digest, components={"my_robot.py": "1"})
    assert begun.readable(asked.document(), "a run", Begun(versions, {})).digest == asked.digest
    monkeypatch.setattr(sources, "own", lambda modules: {"my_robot.py": "2"})
    with pytest.raises(OtherCode, match=r"components/my_robot\.py has changed"):
        begun.readable(asked.document(), "a run", Begun(versions, {}))


TARGET = Processor(model="any", target="znver9", features="a b")


@pytest.mark.parametrize(
    ("then", "named"),
    [
        ({"cpu": TARGET}, ["znver9"]),
        ({"system": "Plan9"}, ["Plan9"]),
        ({"cpu": None, "system": "Plan9"}, []),
        ({"code": None}, ["digests"]),
        ({}, []),
    ],
)
def test_another_machine_may_request_other_points(then: dict[str, Any], named: list[str]) -> None:
    versions = provenance.machine().model_copy(update={"code": "0" * 64, **then})
    found = begun.elsewhere(Begun(versions, {}))
    assert [name for name in ("znver9", "Plan9", "digests") if any(name in clause for clause in found)] == named
    assert len(found) == len(named)
    assert begun.elsewhere(None) == []
