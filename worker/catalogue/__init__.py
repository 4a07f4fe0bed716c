"""What this installation has: components and search methods, found by presence. Start reading at `installed`."""
