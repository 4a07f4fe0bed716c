"""Progress as server-sent events, from one poller for all listeners."""
