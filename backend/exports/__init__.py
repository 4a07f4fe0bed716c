"""The files of a run: a format is one file in `formats`."""
