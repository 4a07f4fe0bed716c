"""Readers of flight logs, on logs that the tests write. Start reading at `test_logs`."""
