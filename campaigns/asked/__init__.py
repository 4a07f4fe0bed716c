"""What may be asked: the campaign and how it is read. Start reading at `spec`."""
