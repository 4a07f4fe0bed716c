# One image for the backend and the workers. Every step is in tools/image.sh, which also runs without an engine.

# By digest, so that what was examined is what is built: Node 22.23.2 on bookworm, Python 3.11.16 on trixie, each an index of
# several architectures. Newer ones: docs/operation.md, Releases.
ARG NODE_IMAGE=node:22-slim@sha256:83f487e0a63425e5b4d146fb5e5be574bcbe1b7b843d3ebafdd95eaf7767a7e5
ARG PYTHON_IMAGE=python:3.11-slim@sha256:9c900dea9e8fb7e16277c179b555cc72d29a352dbc33cff48ad5a0412fd5bfc7
FROM ${PYTHON_IMAGE} AS app
WORKDIR /app
COPY tools tools
RUN tools/image.sh system
COPY requirements.lock ./
RUN tools/image.sh packages
COPY pyproject.toml README.md ./
COPY campaigns campaigns
COPY clearance clearance
COPY backend backend
COPY worker worker
COPY docs docs
RUN tools/image.sh app

FROM ${NODE_IMAGE} AS pages
WORKDIR /app
COPY tools tools
COPY docs docs
COPY frontend frontend
COPY --from=app /app/frontend/src/generated frontend/src/generated
RUN tools/image.sh pages

FROM app
RUN rm -r frontend/src
COPY --from=pages /app/frontend/dist frontend/dist

# Not root, and nothing of /app is writable; /data is the one place that is.
RUN useradd --uid 10001 --user-group --no-create-home --home-dir /data clearance \
    && mkdir /data && chown clearance:clearance /data && chmod 700 /data
USER 10001:10001
# Engines forbid the name spaces of which Chromium makes its sandbox; the container without rights takes its place.
ENV PATH=/app/.venv/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    CLEARANCE_DATA=/data \
    CLEARANCE_BROWSER_SANDBOX=false \
    CLEARANCE_KERNEL_CACHE=/data/kernels
VOLUME /data
EXPOSE 8000
CMD ["python", "-P", "-m", "backend"]
