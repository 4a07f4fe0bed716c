"""Discovery of installed components, search methods and simulators. Start reading at `installed`."""
