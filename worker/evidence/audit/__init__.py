"""An independent check that a verdict follows from the stored data of a run. Start reading at `judge.audit`."""
