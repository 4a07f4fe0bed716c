"""The image and the services of the compose file without an engine: Debian's packages as the base, and name spaces."""
