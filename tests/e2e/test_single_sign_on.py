"""A shared link below a path leads through a real provider to the run and its 3D view; no request leaves the path."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.axe import AXE, violations
from tests.e2e.browser import draws, visiting
from tests.e2e.stored import opened
from tests.faults.processes import until
from tests.given.finished_runs import finish
from tests.given.openid_provider import CLIENT, SECRET, local_provider
from tests.given.submissions import submit
from tests.migrated import migrated

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(120)]

ROOT = "/clearance"


@pytest.mark.nightly  # by day tests/api/provider, with a real provider
def test_a_shared_link_leads_through_the_provider_to_the_run(browser: Browser, tmp_path: Path) -> None:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    migrated(tmp_path)
    public = f"http://127.0.0.1:{port}{ROOT}"
    given = {"port": port, "public_url": public, "oidc_client_id": CLIENT, "oidc_client_secret": SECRET}
    given |= {"oidc_name": "Example", "oidc_roles": '{"eng": "engineer"}'}
    with (
        local_provider() as local,
        opened(tmp_path, oidc_issuer=local.issuer, **given) as service,
        visiting(browser, public.removesuffix(ROOT), views=False) as visit,
    ):
        service.publish()
        with service.signed_in() as admin:
            admin.base_url = public  # type: ignore[assignment]
            run = submit(admin)
        finish(service)
        page, elsewhere = visit.page, list[str]()
        page.add_init_script(path=AXE)
        page.on("request", lambda sent: elsewhere.append(sent.url))
        shared = f"{public}/runs/{run}?finding=F1&t=1.00"
        # Chromium reports a page that is answered with 401 as an error; the page that leads there is answered with 200.
        page.goto(f"{public}/login?next={ROOT}/runs/{run}?finding=F1%26t=1.00")
        assert violations(page) == []
        visit.shot("provider")
        page.get_by_role("link", name="Sign in with Example").click()
        page.wait_for_url(shared)
        expect(page.get_by_role("button", name="Session of ada")).to_be_visible()
        frame = page.frame_locator("iframe").first
        expect(frame.locator("canvas").first).to_be_attached()
        until(lambda: draws(frame), "the view is drawn", 60)
        page.get_by_role("button", name="Export").first.click()
        expect(page.get_by_role("menuitem", name="Download as one file")).to_have_attribute(
            "href", f"{ROOT}/api/v1/runs/{run}/exports/flight-F1.html?theme=light"
        )
        page.keyboard.press("Escape")
        page.get_by_role("link", name="Runs", exact=True).first.click()
        page.wait_for_url(f"{public}/runs")
        expect(page.get_by_role("link", name="Unicycle past a pillar").first).to_be_visible()
        asked = f"left the service: {local.issuer}/authorize?"
        visit.wrong[:] = [wrong for wrong in visit.wrong if not wrong.startswith(asked)]
        paths = (f"{public}/", f"{local.issuer}/authorize?", "data:", "blob:")
        assert [url for url in elsewhere if not url.startswith(paths)] == []
