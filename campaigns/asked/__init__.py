"""What may be asked: the campaign, how it is read and checked, and the plan of its stages. Start reading at `spec`."""
