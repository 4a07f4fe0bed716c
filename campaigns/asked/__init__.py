"""The campaign, how it is read and validated, and the plan of its stages. Start reading at `spec`."""
