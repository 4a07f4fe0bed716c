"""Components, methods and the library of campaigns."""
