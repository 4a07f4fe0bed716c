"""A colleague's way: invited, led through sign-in to a shared instant, signs off; and takes the evidence away.

The engineer who launched the run is in a browser of their own and may not sign it. The run is stored, not simulated.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from clearance.cli import invoke
from tests.e2e.browser import Visit, undrawn, visiting
from tests.e2e.stored import served
from tests.given.joined_users import PASSWORD
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(180)]

SHARED = "/runs/R-0001?finding=F1&t=7.25&cam=top"
ENGINEER, REVIEWER = "erin", "rae@example.org"


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    with served(tmp_path) as service:
        yield service


@pytest.mark.nightly  # by day test_signatures.py and test_access_pages.py
def test_a_colleague_reviews_what_an_engineer_may_not_sign(service: Service, browser: Browser, tmp_path: Path) -> None:
    with ExitStack() as stack:
        admin, engineer, reviewer = (stack.enter_context(visiting(browser, service.url, views=False)) for _ in range(3))
        admin.go(f"/login?code={service.login_code()}")
        joins(engineer, invitation(admin.page, ENGINEER, "engineer"), ENGINEER)
        joins(reviewer, invitation(admin.page, REVIEWER, "reviewer"), REVIEWER)
        signs_out(reviewer.page)
        launched(engineer, service)
        arrives_at_the_instant(reviewer)
        with undrawn(engineer.page):
            may_not_sign(engineer)
        signs_off(reviewer)
        takes_the_evidence_away(reviewer, tmp_path)
        engineer.go("/access/sessions")
        expect(engineer.page.get_by_role("link", name="API tokens")).to_be_visible()
        expect(engineer.page.get_by_role("link", name="Audit trail")).to_have_count(0)


def invitation(page: Page, name: str, role: str) -> str:
    """The link that the page shows to an administrator who invites a user."""
    page.get_by_role("button", name="Session of local").click()
    page.get_by_role("menuitem", name="Invite").click()
    dialog = page.get_by_role("dialog", name="Invite a user")
    dialog.get_by_role("textbox", name="Name").fill(name)
    dialog.get_by_role("radio", name=re.compile(f"^{role} ")).check()
    dialog.get_by_role("button", name="Make the link").click()
    link = dialog.get_by_test_id("secret").inner_text()
    dialog.get_by_role("button", name="Done").click()
    return link


def joins(visit: Visit, link: str, name: str) -> None:
    visit.page.goto(link)
    visit.page.get_by_label("New password", exact=True).fill(PASSWORD)
    visit.page.get_by_label("The same password again").fill(PASSWORD)
    visit.page.get_by_role("button", name="Set the password and sign in").click()
    expect(visit.page.get_by_role("button", name=f"Session of {name}")).to_be_visible()


def signs_out(page: Page) -> None:
    page.get_by_role("button", name=re.compile("^Session of")).click()
    page.get_by_role("menuitem", name="Sign out").click()
    expect(page.get_by_role("link", name="sign in")).to_be_visible()


def launched(engineer: Visit, service: Service) -> None:
    """A finished run that the engineer's browser has submitted, evidence for SYS-1."""
    stated = {"threshold": 0.5, "requirements": [{"id": "SYS-1", "text": "Keeps 0.5 m away."}]}
    sent = {"campaign": campaign(criterion=stated)}
    request, address = engineer.page.request, f"{engineer.address}/api/v1/runs"
    answer = request.post(address, data=sent, headers={"Origin": engineer.address})
    assert answer.status == 201, answer.text()
    finish_fully(service)


def arrives_at_the_instant(reviewer: Visit) -> None:
    """Signed out, the shared link leads through sign-in to exactly itself: flight, finding and instant."""
    page = reviewer.page
    page.goto(reviewer.address + SHARED)
    reviewer.wrong.clear()  # the browser reports the 401 of the sign-in page on its console
    page.get_by_label("Name").fill(REVIEWER)
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Sign in").click()
    expect(page).to_have_url(reviewer.address + SHARED)
    expect(page.locator("tr[data-finding=F1]").get_by_role("button")).to_have_attribute("aria-pressed", "true")
    page.locator("#flight iframe").scroll_into_view_if_needed()
    time = page.get_by_role("group", name="Time of the flight").get_by_role("slider", name="Time")
    expect(time).to_have_value("7.25")
    expect(page).to_have_url(reviewer.address + SHARED)


def signature(visit: Visit) -> Locator:
    """The card of sign-offs on the page of the run."""
    visit.stay("/runs/R-0001")
    return visit.page.locator("#signoff")


def may_not_sign(engineer: Visit) -> None:
    """The page disables the button and says why; the service refuses the request that the page does not send."""
    card = signature(engineer)
    button = card.get_by_role("button", name="Sign off")
    expect(button).to_be_disabled()
    expect(button).to_have_attribute("title", re.compile("^You launched R-0001: another reviewer must sign it off"))
    barred = engineer.page.request.get(f"{engineer.address}/api/v1/runs/R-0001/signoffs").json()["barred"]
    expect(card).to_contain_text(barred[1:])
    expect(engineer.page.get_by_role("button", name="Change name and tags")).to_be_enabled()
    signoffs, request = f"{engineer.address}/api/v1/runs/R-0001/signoffs", engineer.page.request
    given = {"role": "Independent review", "digest": request.get(signoffs).json()["digest"]}
    refused = request.post(signoffs, data=given, headers={"Origin": engineer.address})
    assert (refused.status, refused.json()["type"]) == (403, "urn:clearance:problem:role-too-low")
    assert request.get(signoffs).json()["items"] == []
    assert request.get(f"{engineer.address}/api/v1/audit/export").status == 403


COMMENT = "The bounds agree with the hazard log."


def signs_off(reviewer: Visit) -> None:
    """The reviewer signs off with a statement; what is the engineer's own stays theirs."""
    card = signature(reviewer)
    edit = reviewer.page.get_by_role("button", name="Change name and tags")
    expect(edit).to_be_disabled()
    expect(edit).to_have_attribute("title", re.compile(f"^R-0001 belongs to {ENGINEER}, and you are {REVIEWER}"))
    card.get_by_role("button", name="Sign off").click()
    dialog = reviewer.page.get_by_role("dialog")
    expect(dialog.get_by_role("textbox", name="Name")).to_have_count(0)  # it is under the account's name
    dialog.get_by_role("textbox", name="Comment").fill(COMMENT)
    dialog.get_by_role("button", name="Sign off").click()
    row = card.get_by_role("row", name=re.compile(REVIEWER))
    expect(row).to_contain_text("Valid")
    expect(row).to_contain_text(COMMENT)
    expect(row).not_to_contain_text("who also launched the run")


def takes_the_evidence_away(assessor: Visit, folder: Path) -> None:
    """The report, the matrix of requirements and the audit trail name the sign-off; the trail is verified as a file."""
    page = assessor.page
    page.get_by_role("button", name="Export").click()
    with page.context.expect_page() as opened:
        page.get_by_role("menuitem", name="Safety-case report, HTML").click()
    expect(opened.value.get_by_role("cell", name=re.compile(REVIEWER)).first).to_be_visible()
    opened.value.close()
    assessor.go("/requirements")
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as matrix:
        page.get_by_role("menuitem", name=re.compile("^Matrix")).click()
    (row,) = csv.DictReader(matrix.value.path().read_text(encoding="utf-8-sig").splitlines())
    assert (row["requirement"], row["run"]) == ("SYS-1", "R-0001"), row
    assert (row["signed"], row["signed_by"].partition(" (")[0]) == ("yes", REVIEWER), row
    page.keyboard.press("Escape")
    page.get_by_role("button", name=f"Session of {REVIEWER}").click()
    page.get_by_role("menuitem", name="Audit trail").click()
    with page.expect_download() as trail:
        page.get_by_role("link", name="Export as JSON lines").click()
    file = folder / "trail.jsonl"
    trail.value.save_as(file)
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    assert ("signoff.created", REVIEWER) in {(row["action"], row["user"]) for row in rows}
    assert (rows[-1]["action"], rows[-1]["user"]) == ("audit.exported", REVIEWER)
    assert invoke(["trail", "verify", "--file", str(file), "--head", f"{rows[-1]['id']}:{rows[-1]['hash']}"]) == 0
