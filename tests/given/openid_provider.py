"""A small OpenID Connect provider on loopback: real HTTP, real signatures, its own check of PKCE and of the client.

Tests set who is signed in at it, and what it does wrong. It shares no code with the service.
"""

from __future__ import annotations

import base64
import hashlib
import json
import secrets
import threading
import time
import urllib.parse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from joserfc import jwt
from joserfc.jwk import ECKey, OctKey, RSAKey

CLIENT, SECRET = "clearance", "a secret: with %20 and ü"


@dataclass
class Local:
    """The state of the provider."""

    issuer: str = ""
    person: dict[str, Any] = field(
        default_factory=lambda: {"sub": "s-1", "preferred_username": "ada", "groups": ["eng"]}
    )
    in_token: bool = True
    """Whether groups and name are in the ID token, or only in the user information."""
    claims: dict[str, Any] = field(default_factory=dict)
    """Replaced in the next ID tokens; None removes a claim."""
    algorithm: str = "RS256"
    """Of the next ID tokens; `none` signs nothing, `HS256` signs with the public key."""
    denied: bool = False
    down: bool = False
    said_issuer: str = ""
    """The issuer of the configuration, if it is another one."""
    userinfo_subject: str = ""
    returned: dict[str, str] = field(default_factory=dict)
    """More parameters of its answers to the browser."""
    asked: list[dict[str, str]] = field(default_factory=list)
    """The parameters of every authorization request."""
    answered: int = 0
    """Requests for its configuration."""
    codes: dict[str, dict[str, str]] = field(default_factory=dict)
    keys: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.renew_keys()

    def renew_keys(self) -> None:
        """Replace the keys, as providers do."""
        number = secrets.token_hex(4)
        self.keys = {
            "RS256": RSAKey.generate_key(2048, {"kid": f"rsa-{number}", "use": "sig"}),
            "ES256": ECKey.generate_key("P-256", {"kid": f"ec-{number}", "use": "sig"}),
        }

    def public(self) -> dict[str, Any]:
        unknown = {"kty": "AKP", "kid": "later", "alg": "ML-DSA-44", "pub": "AA"}
        return {"keys": [unknown, *(key.as_dict(private=False) for key in self.keys.values())]}

    def id_token(self, asked: dict[str, str], access: str) -> str:
        at = int(time.time())
        half = base64.urlsafe_b64encode(hashlib.sha256(access.encode()).digest()[:16]).rstrip(b"=").decode()
        told = self.person if self.in_token else {"sub": self.person["sub"]}
        claims = {
            "iss": self.issuer,
            "aud": CLIENT,
            "exp": at + 300,
            "iat": at,
            "nonce": asked["nonce"],
            "at_hash": half,
        }
        claims = {name: value for name, value in {**claims, **told, **self.claims}.items() if value is not None}
        if self.algorithm == "none":
            parts = ({"alg": "none"}, claims)
            return ".".join(base64.urlsafe_b64encode(json.dumps(p).encode()).rstrip(b"=").decode() for p in parts) + "."
        if self.algorithm == "HS256":
            key = OctKey.import_key(json.dumps(self.public()["keys"][1]))
            return jwt.encode({"alg": "HS256", "kid": self.keys["RS256"].kid}, claims, key, algorithms=["HS256"])
        if self.algorithm == "foreign":
            key = RSAKey.generate_key(2048)
            return jwt.encode({"alg": "RS256", "kid": self.keys["RS256"].kid}, claims, key)
        key = self.keys[self.algorithm]
        return jwt.encode({"alg": self.algorithm, "kid": key.kid}, claims, key, algorithms=[self.algorithm])


class _Handler(BaseHTTPRequestHandler):
    local: Local

    def log_message(self, *_: Any) -> None:
        pass

    def do_GET(self) -> None:
        local, address = self.local, urllib.parse.urlsplit(self.path)
        if local.down:
            self.send_error(503)
        elif address.path == "/.well-known/openid-configuration":
            local.answered += 1
            names = {"authorization_endpoint": "authorize", "token_endpoint": "token", "jwks_uri": "keys"}
            found = {name: f"{local.issuer}/{path}" for name, path in (names | {"userinfo_endpoint": "me"}).items()}
            self._json(200, {"issuer": local.said_issuer or local.issuer, **found})
        elif address.path == "/keys":
            self._json(200, local.public())
        elif address.path == "/authorize":
            self._authorize(dict(urllib.parse.parse_qsl(address.query)))
        elif address.path == "/me" and self.headers["Authorization"] == "Bearer access-1":
            self._json(200, {**local.person, "sub": local.userinfo_subject or local.person["sub"]})
        else:
            self._json(404, {"error": "not_found"})

    def do_POST(self) -> None:
        form = dict(urllib.parse.parse_qsl(self.rfile.read(int(self.headers["Content-Length"])).decode()))
        asked = self.local.codes.pop(form.get("code", ""), None)
        quoted = (urllib.parse.quote(one, safe="") for one in (CLIENT, SECRET))
        expected = "Basic " + base64.b64encode(":".join(quoted).encode()).decode()
        if self.headers["Authorization"] != expected:
            self._json(401, {"error": "invalid_client"})
            return
        verifier = hashlib.sha256(form.get("code_verifier", "").encode()).digest()
        challenge = base64.urlsafe_b64encode(verifier).rstrip(b"=").decode()
        right = asked is not None and (asked["code_challenge"], asked["code_challenge_method"]) == (challenge, "S256")
        if not right or asked is None or form.get("redirect_uri") != asked["redirect_uri"]:
            self._json(400, {"error": "invalid_grant"})
            return
        token = self.local.id_token(asked, "access-1")
        self._json(200, {"access_token": "access-1", "token_type": "Bearer", "id_token": token})

    def _authorize(self, asked: dict[str, str]) -> None:
        self.local.asked.append(asked)
        back = {"state": asked["state"]}
        if self.local.denied:
            back["error"] = "access_denied"
        else:
            back["code"] = secrets.token_urlsafe(16)
            self.local.codes[back["code"]] = asked
        self.send_response(302)
        query = urllib.parse.urlencode(back | self.local.returned)
        self.send_header("Location", f"{asked['redirect_uri']}?{query}")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def _json(self, status: int, found: dict[str, Any]) -> None:
        body = json.dumps(found).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


@contextmanager
def local_provider() -> Iterator[Local]:
    """A running provider."""
    local = Local()
    handler = type("Handler", (_Handler,), {"local": local})
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        local.issuer = f"http://127.0.0.1:{server.server_port}"
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        thread.start()
        try:
            yield local
        finally:
            server.shutdown()
            thread.join()
