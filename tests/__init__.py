"""The tests, by kind: see the folder names."""
