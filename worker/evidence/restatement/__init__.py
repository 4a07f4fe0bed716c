"""The sentences of a stored verdict, made again from its record."""
