"""The files of a run: a format is one file in `formats`. Start reading at `format.Format`."""
