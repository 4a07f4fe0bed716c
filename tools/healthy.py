"""Ends with 0 when the service in this container (CLEARANCE_PORT, or 8000) answers its health check, else with 1."""

import os
import sys
import urllib.request

URL = f"http://127.0.0.1:{os.environ.get('CLEARANCE_PORT') or 8000}/api/v1/health"

try:
    # Asks this machine itself, whatever proxy the environment names.
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(URL, timeout=5) as answer:
        sys.exit(0 if answer.status == 200 else 1)
except OSError as error:
    sys.exit(f"{URL}: {error}")
