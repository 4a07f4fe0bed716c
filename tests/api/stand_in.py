"""A stand-in of the simulation process that responds immediately."""

from __future__ import annotations

STAND_IN = """
import json, os, sys, time
print(json.dumps({"ready": True}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    name = asked["campaign"]["name"]
    if name == "dies": os._exit(3)
    if name == "slow": time.sleep(60)
    if name == "refused": print(json.dumps({"id": asked["id"], "error": "there is no trim"}), flush=True); continue
    columns = {"t": [0.0, 1.0], "x": [0.0, None], "y": [0.0, 1.0], "z": [0.0, 0.0], "yaw": [0.0, 0.1]}
    meta = {"obstacles": [{"moving": False}], "threshold": 0.5, "frame": "enu", "closest": None}
    failed = {"status": "failed", "reason": "it overturned", "cost": None, "margin": None}
    print(json.dumps({"id": asked["id"], **failed, "data": columns, "meta": meta}), flush=True)
"""
