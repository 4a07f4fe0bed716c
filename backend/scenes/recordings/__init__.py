"""A flight as a self-contained page that plays without a server."""
