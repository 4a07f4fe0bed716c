"""The service: REST, pages, 3D. Never imports `worker`; start reading at `backend.app`.

All features share `http`, `middleware` and `access`; only `app`, `__main__` and `openapi` import features.
"""
