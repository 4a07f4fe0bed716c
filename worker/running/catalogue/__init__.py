"""Discovery of installed components, search methods and simulators."""
