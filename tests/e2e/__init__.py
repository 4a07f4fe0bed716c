"""The whole way in a real browser, on real processes: `clearance serve` with its own data, Debian's chromium."""
