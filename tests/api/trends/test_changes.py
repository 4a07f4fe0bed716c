"""What of two runs is a change of the code, of the campaign, or neither: in a trend, and between two runs."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import CodeVersion, Run
from campaigns.runs import run_number
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

CORE, BASELINE, OTHER = "worker.engine.problem.problem", "campaigns.stages.baseline", "worker.engine.components.other"
PLAIN = {CORE: "0"}
WITHOUT_ONE: list[tuple[dict[str, str], list[str]]] = [
    ({**PLAIN, BASELINE: "1"}, []),
    ({CORE: "9", BASELINE: "1"}, [CORE]),
]
"""The modules of a run that uses one more, and what of them is a change."""


def ran_by(
    service: Service,
    run: str,
    code: str,
    modules: dict[str, str],
    components: dict[str, str] | None = None,
    loop: str = "",
) -> None:
    flown = {"code": code, "loop": loop or code, "components": components or {}}
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == run_number(run)).values(flown=flown))
        writer.execute(sa.insert(CodeVersion).values(digest=code, modules=modules, created=1.0))


def finished(service: Service, client: httpx.Client) -> str:
    run = submit(client)
    finish_fully(service)
    return run


def trend(client: httpx.Client) -> dict[str, Any]:
    return dict(client.get("/api/v1/trends", params={"name": campaign()["name"]}).json())


def between(client: httpx.Client, run: str, other: str) -> dict[str, Any]:
    return dict(client.get(f"/api/v1/runs/{other}/code", params={"against": run}).json())


@pytest.mark.parametrize(("modules", "names"), WITHOUT_ONE)
def test_a_baseline_that_was_added_at_launch_is_no_change(
    service: Service, client: httpx.Client, modules: dict[str, str], names: list[str]
) -> None:
    one = finished(service, client)
    other = str(client.post("/api/v1/runs", json={"campaign": campaign(), "baseline": one}).json()["id"])
    ran_by(service, one, "a", PLAIN, loop="same")
    ran_by(service, other, "b", modules, loop="same")
    found = trend(client)
    newest = found["runs"][1]
    assert (newest["code_changed"], newest["code_changes"]) == (bool(names), names)
    assert (newest["campaign_changed"], found["campaigns"]) == (False, 1)
    assert newest["campaign_digest"] != found["runs"][0]["campaign_digest"]
    text = between(client, one, other)
    assert [file["file"] for file in text["files"]] == [f"{name.replace('.', '/')}.py" for name in names]
    assert len(text["changes"]) == len(names)
    assert not any(BASELINE in clause for clause in text["changes"])


def test_what_only_one_of_two_campaigns_uses_is_a_change_of_the_campaign(
    service: Service, client: httpx.Client
) -> None:
    one = finished(service, client)
    other = submit(client, seed=2)
    ran_by(service, one, "a", {**PLAIN, BASELINE: "1"}, {"my_robot.py": "1"})
    ran_by(service, other, "b", {**PLAIN, OTHER: "1"}, {"my_way.py": "1"})
    newest = trend(client)["runs"][1]
    assert (newest["code_changed"], newest["code_changes"], newest["campaign_changed"]) == (False, [], True)
    assert (between(client, one, other)["changes"], between(client, one, other)["files"]) == ([], [])


def test_what_only_one_run_of_a_campaign_uses_is_a_change_of_the_code(service: Service, client: httpx.Client) -> None:
    """Such as a module that was added to the engine, or a component that became an own file."""
    one, other = finished(service, client), submit(client)
    ran_by(service, one, "a", {**PLAIN, OTHER: "1"})
    ran_by(service, other, "b", PLAIN, {"my_way.py": "1"})
    newest = trend(client)["runs"][1]
    assert (newest["code_changes"], newest["campaign_changed"]) == (["components/my_way.py", OTHER], False)
    with service.engine.begin() as writer:
        writer.execute(sa.delete(CodeVersion))
    assert trend(client)["runs"][1]["code_changed"], "which modules differ is not stored"
