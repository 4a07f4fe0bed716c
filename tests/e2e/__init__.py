"""End-to-end tests in a real browser with real processes: `clearance serve` with its own data, Debian's chromium."""
