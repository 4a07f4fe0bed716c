"""A flight as a page that plays without a server."""
