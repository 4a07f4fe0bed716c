"""Where signing in leads: only to pages of our own, whatever the address says."""

from __future__ import annotations

import pytest

from backend.http.forms import START, own_path


@pytest.mark.parametrize(
    "path",
    [
        "/runs/R-0001",
        "/runs/R-0001?finding=F2&t=1.5",
        "/compare?runs=R-0001,R-0002",
        "/runs?q=%C3%A9",
        "/help/guides/access",
    ],
)
def test_addresses_of_our_own_pages_are_accepted(path: str) -> None:
    assert own_path(path) == path


@pytest.mark.parametrize(
    "address",
    [
        *(
            "",
            "runs",
            "https://evil.example/",
            "//evil.example",
            "///evil.example",
            "/\\evil.example",
            "\\\\evil.example",
        ),
        *("/\t/evil.example", "/\n/evil.example", "\t//evil.example", " //evil.example", "javascript:alert(1)"),
        *("/%2F/evil.example/../..", "/%5Cevil.example", "/%2Fevil.example", "http:/evil.example", "data:text/html,x"),
        *(
            "/é",
            "/runs\r\nSet-Cookie: a=b",
            "/runs\0",
            "/" + "x" * 3000,
            "/",
            "/login?next=/login",
            "/login",
            "/invite?code=x",
        ),
        *("/api/v1/session", "/%61pi/v1/audit/export", "/%6Cogin"),
    ],
)
def test_everything_else_leads_to_the_start(address: str) -> None:
    assert own_path(address) == START
