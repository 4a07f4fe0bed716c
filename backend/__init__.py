"""The service: REST, pages, 3D. Never imports `worker`; start reading at `backend.app`."""
