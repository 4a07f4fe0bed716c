"""The stages of a run, one file each, and the verdict over them. Start reading at `base.drive`."""
