"""What must survive: killed workers, stale fences, locked databases, hanging children. Real processes."""
