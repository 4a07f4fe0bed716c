"""One file, one part of the environment: wind, gusts, ground."""
