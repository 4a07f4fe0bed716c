"""The service: REST, pages, 3D. Never imports `worker`; start reading at `backend.app`.

`http`, `middleware` and `access` are what all features share; only `app`, `__main__` and `openapi` import features.
"""
