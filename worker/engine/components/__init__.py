"""The components of a closed loop, a folder a role, a file a component; see `worker.engine.kernels.component`."""
