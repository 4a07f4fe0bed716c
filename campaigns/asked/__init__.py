"""The campaign and how it is read. Start reading at `spec`."""
