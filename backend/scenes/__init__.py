"""Interactive 3D: the viser viewer relayed on the service's port, and live what-if flights."""
