"""Fault tolerance: killed workers, stale fences, locked databases, hanging children. Real processes."""
