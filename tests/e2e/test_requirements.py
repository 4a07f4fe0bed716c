"""The page of requirements, from an empty one to evidence that is suspect: in both themes, and on a telephone."""

from __future__ import annotations

from pathlib import Path

import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, expect

from backend.db.tables import CatalogueDocument
from tests.e2e.axe import AXE, violations
from tests.e2e.browser import visiting
from tests.e2e.looking import within
from tests.e2e.stored import served
from tests.given.code_versions import edited
from tests.given.reported_runs import finish_fully
from tests.given.submissions import submit

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(120), pytest.mark.nightly]  # by day tests/api/requirements

WRITTEN = Path(__file__).parents[1] / "api" / "requirements" / "written.reqif"


def test_from_a_file_of_requirements_to_suspect_evidence(tmp_path: Path, browser: Browser) -> None:
    with served(tmp_path) as service, visiting(browser, service.url) as visit:
        page = visit.page
        page.add_init_script(path=AXE)
        visit.sign_in(service.login_code())
        visit.go("/requirements")
        expect(page.get_by_text("There are no requirements yet.")).to_be_visible()
        expect(page.get_by_role("button", name="Export")).to_be_disabled()
        page.get_by_role("button", name="Import").click()
        dialog = page.get_by_role("dialog", name="Import requirements")
        dialog.get_by_label("File").set_input_files({"name": "a.csv", "mimeType": "text/csv", "buffer": b"a,b\n1,2\n"})
        dialog.get_by_role("button", name="Import").click()
        expect(dialog.get_by_role("alert")).to_contain_text("No column for the id")
        visit.wrong.clear()  # the browser reports the refusal on its console
        assert violations(page, within=["[role=dialog]"]) == []
        dialog.get_by_label("File").set_input_files(WRITTEN)
        dialog.get_by_role("button", name="Import").click()
        expect(dialog.get_by_role("status")).to_contain_text("2 added, 0 changed, 0 unchanged")
        dialog.get_by_role("button", name="Done").click()
        one = page.locator("[data-requirement='SYS-1']")
        expect(one).to_contain_text("No evidence")

        with service.signed_in() as client:
            for name, verdict in (("First", "cleared"), ("Second", "violated")):
                first = name == "First"  # another threshold is another question: neither run speaks against the other
                stated = {"threshold": 0.5 if first else 0.6, "requirements": ["SYS-1" if first else "SYS-2"]}
                run = submit(client, name=name, criterion=stated)
                finish_fully(service, verdict)
            digest = client.get("/api/v1/runs/R-0001/signoffs").json()["digest"]
            body = {"name": "Grace Hopper", "role": "Independent review", "comment": "", "digest": digest}
            assert client.post("/api/v1/runs/R-0001/signoffs", json=body).status_code == 201
        visit.go("/requirements")
        expect(one.get_by_text("Met", exact=True)).to_be_visible()
        expect(one).to_contain_text("+0.800 m")
        expect(page.locator("[data-requirement='SYS-2']").get_by_text("Violated").first).to_be_visible()
        expect(page.get_by_text("2 requirements: 1 violated, 1 met")).to_be_visible()
        with service.engine.begin() as writer:
            writer.execute(sa.update(CatalogueDocument).values(document=edited()))
        visit.go("/requirements?status=suspect")
        with service.signed_in() as client:
            rows = client.get("/api/v1/requirements").json()["items"]
        (change,) = next(row for row in rows if row["id"] == "SYS-1")["runs"][0]["changes"]
        expect(one).to_contain_text(f"Suspect: {change}")
        expect(page.locator("[data-requirement]")).to_have_count(1)
        visit.go("/requirements?q=nothing+like+this")
        expect(page.get_by_text("No requirement matches.")).to_be_visible()
        expect(page.get_by_role("button", name="Export")).to_be_enabled()  # all of them, whatever is searched for
        page.get_by_role("button", name="Show all requirements").click()
        expect(page.locator("[data-requirement]")).to_have_count(2)
        for theme in ("light", "dark"):
            page.emulate_media(color_scheme=theme)
            expect(page.locator("html")).to_have_attribute("data-theme", theme)
            assert violations(page) == [], theme
        page.set_viewport_size({"width": 390, "height": 844})
        within(page, 390)
        with page.expect_download() as saved:
            page.get_by_role("link", name="Download written.reqif").click()
        assert Path(saved.value.path()).read_bytes() == WRITTEN.read_bytes()
        page.locator("[data-requirement='SYS-2']").get_by_role("link", name=run, exact=True).click()
        page.get_by_test_id("requirements").get_by_role("link", name="SYS-2").click()
        expect(page.locator("[data-requirement]")).to_have_count(1)
