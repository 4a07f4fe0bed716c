"""Components, methods and the campaign library."""
