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
    print(json.dumps({"id": asked["id"], **failed, "data": columns, "meta": meta, "identity": {}}), flush=True)
"""

FLYING = """
import json, sys
print(json.dumps({"ready": True}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    columns = [{"name": "t", "symbol": "t", "unit": "s", "group": "time"}]
    columns += [{"name": n, "symbol": n, "unit": "m", "group": "pose"} for n in ("x", "y")]
    data = {"t": [0.0, 1.0], "x": [0.0, 1.0], "y": [0.0, 1.0]}
    meta = {"parameters": asked.get("parameters", {}), "status": "ok", "cost": 1.0, "values": {"separation": 1.0}}
    told = {"status": "ok", "reason": "", "cost": 1.0, "margin": 0.5, "columns": columns, "data": data, "meta": meta}
    print(json.dumps({"id": asked["id"], **told, "identity": {}}), flush=True)
"""
"""That of what-ifs, whose flight has two rows."""
