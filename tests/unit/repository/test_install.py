"""What `make install` tells the tools that it uses."""

from __future__ import annotations

import os
import subprocess

from tests.faults.processes import REPOSITORY


def test_uv_is_told_of_the_indexes_and_certificates_that_pip_is_told_of() -> None:
    told = {
        "PIP_INDEX_URL": "https://a.example/simple?x=1",
        "PIP_EXTRA_INDEX_URL": "https://b.example/simple https://c.example/simple",
        "PIP_FIND_LINKS": "/one /two",
        "PIP_CERT": "/etc/certificates.pem",
    }
    program = 'source tools/common.sh; source tools/uv.sh; as_pip; env | grep -E "^(UV_|SSL_CERT_FILE)" | sort'
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PIP_", "UV_", "SSL_"))} | told
    environment["PIP_CONFIG_FILE"] = os.devnull
    shell = ["bash", "-c", program, str(REPOSITORY / "tools" / "x")]
    found = subprocess.run(shell, cwd=REPOSITORY, env=environment, capture_output=True, text=True, check=False)
    assert found.stdout.splitlines() == [
        "SSL_CERT_FILE=/etc/certificates.pem",
        "UV_DEFAULT_INDEX=https://a.example/simple?x=1",
        "UV_FIND_LINKS=/one,/two",
        "UV_INDEX=https://b.example/simple https://c.example/simple",
    ], found.stderr
