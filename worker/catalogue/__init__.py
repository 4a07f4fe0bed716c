"""What this installation has: components, search methods and simulators. Start reading at `installed`."""
