"""The plain pages with which users sign in and accept invitations; they need no script."""

from __future__ import annotations

import html
import urllib.parse

from fastapi import Request
from fastapi.responses import HTMLResponse
from starlette.types import Scope

from backend.db.passwords import SHORTEST
from backend.http.errors import RefusedError
from backend.http.pages import plain
from backend.http.root import at, inside

START = "/runs"
LONGEST = 2000
"""Maximum length of the address to which signing in leads back."""

LARGEST_FORM = 10_000
"""Maximum size of a submitted form [bytes]."""

_NOWHERE = ("/login", "/invite", "/api/")
_OR = '<p class="or">or with a name and a password</p>'
_AUTO = 'autocapitalize="none" spellcheck="false"'


def own_path(address: str) -> str:
    """The address if it is one of this service's own pages, else the start page: no open redirect.

    Both are as a browser requests them, with the path of the public address. A browser reads `//host`, `/\\host` and a
    tab or newline inside such a prefix as another server (WHATWG URL).
    """
    plain_text = address.isascii() and address.isprintable() and " " not in address and "\\" not in address
    own = inside(address)
    if not plain_text or len(address) > LONGEST or own is None or not own.startswith("/") or own.startswith("//"):
        return at(START)
    path = urllib.parse.unquote(urllib.parse.urlsplit(own).path)
    return at(START) if path == "/" or path.startswith(_NOWHERE) or path.startswith("//") or "\\" in path else address


def quoted(address: str) -> str:
    return urllib.parse.quote(address, safe="")


def address_of(scope: Scope) -> str:
    """Path and query of a request, as the browser sent it."""
    query = scope["query_string"].decode("latin-1")
    return at(urllib.parse.quote(scope["path"])) + (f"?{query}" if query else "")


async def fields(request: Request) -> dict[str, str]:
    """The fields of a submitted form; 400 for anything else."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    body = await request.body()
    if kind != "application/x-www-form-urlencoded" or len(body) > LARGEST_FORM:
        detail = f"send a form as application/x-www-form-urlencoded of at most {LARGEST_FORM:,} bytes"
        raise RefusedError("bad-request", detail)
    try:
        found = urllib.parse.parse_qsl(body.decode("ascii"), keep_blank_values=True, max_num_fields=20, errors="strict")
    except ValueError:
        raise RefusedError("bad-request", "the form is not URL-encoded UTF-8 text") from None
    return dict(found)


def sign_in(
    status: int,
    passwords: bool,
    back: str,
    why: str = "Sign in to Clearance",
    wrong: str = "",
    name: str = "",
    provider: str = "",
) -> HTMLResponse:
    """The page shown without a session: the form if any user has a password, and how to obtain a login link.

    back: where signing in leads. wrong: why the last attempt failed. name: what was typed. provider: empty without one.
    """
    form = _form(back, wrong, name) if passwords else ""
    between = _OR if provider and passwords else ""
    return plain(why, f"{_through(provider, back) if provider else ''}{between}{form}{_links(passwords)}", status)


def _through(provider: str, back: str) -> str:
    """A link, not a form: the policy on forms would stop the redirect to another server."""
    address = f"{at('/login/provider')}?next={quoted(own_path(back))}"
    return f'<p><a class="button" href="{html.escape(address)}">Sign in with {html.escape(provider)}</a></p>'


def invitation(status: int, user: str, code: str, wrong: str = "") -> HTMLResponse:
    body = (
        f"<p>You are invited as <b>{html.escape(user)}</b>. Choose a password of at least {SHORTEST} characters; "
        "several words make a good one.</p>"
        f'{_wrong(wrong)}<form method="post" action="{at("/invite")}">'
        f'<input type="hidden" name="code" value="{html.escape(code)}">'
        f'<input type="hidden" name="username" autocomplete="username" value="{html.escape(user)}">'
        f"{_password('password', 'New password', 'new-password', focus=True)}"
        f"{_password('again', 'The same password again', 'new-password')}"
        "<button>Set the password and sign in</button></form>"
    )
    return plain("Welcome to Clearance", body, status)


def no_invitation() -> HTMLResponse:
    body = (
        "<p>Each invitation is single-use, expires after three days, and is replaced by a newer one. Ask an "
        f'administrator for a new link. If you have a password already, <a href="{at("/login")}">sign in</a>.</p>'
    )
    return plain("This invitation is invalid or expired", body, 403)


def _form(back: str, wrong: str, name: str) -> str:
    focus = "" if name else " autofocus"
    return (
        f'{_wrong(wrong)}<form method="post" action="{at("/login")}">'
        f'<input type="hidden" name="next" value="{html.escape(own_path(back))}">'
        f'<label for="name">Name</label><input id="name" name="name" value="{html.escape(name)}" maxlength="64" '
        f'autocomplete="username" required {_AUTO}{focus}>'
        f"{_password('password', 'Password', 'current-password', focus=bool(name))}<button>Sign in</button></form>"
    )


def _password(name: str, label: str, kind: str, focus: bool = False) -> str:
    return (
        f'<label for="{name}">{label}</label><input id="{name}" name="{name}" type="password" maxlength="200" '
        f'autocomplete="{kind}" required{" autofocus" if focus else ""}>'
    )


def _wrong(text: str) -> str:
    return f'<p class="wrong" role="alert">{html.escape(text)}</p>' if text else ""


def _links(passwords: bool) -> str:
    first = "Or open" if passwords else "Open"
    forgotten = "<p>Forgotten your password? Ask an administrator for a new link.</p>" if passwords else ""
    return (
        f"{forgotten}<p>{first} the login link that the service printed when it started; it is in the output of "
        "<code>clearance serve</code> or <code>make run</code>, or in the container's log.</p>"
        "<p>Each link is single-use, expires after 15 minutes, and is replaced by a newer link. "
        "For a new link run <code>clearance login-link</code>.</p>"
    )
