"""The components of a closed loop, a folder a role, a file a component; the contract is `worker.kernels.component`."""
