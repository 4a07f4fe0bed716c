"""The tests, by what they hold: see the folder names."""
