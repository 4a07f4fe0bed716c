"""From a campaign to the system that it names and to its problem. Start reading at `opened`."""
