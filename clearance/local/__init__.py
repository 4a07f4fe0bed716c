"""A campaign run in this process, without a service: its progress, interruption, failures and files of results."""
