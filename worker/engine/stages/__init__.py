"""The stages of a run, one file each. Start reading at `parts.base.drive`, then any stage."""
