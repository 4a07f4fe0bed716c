"""FMUs as simulators, built by the tests from C sources."""
