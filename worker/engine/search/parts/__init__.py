"""Shared parts of the search methods: local descents, clustering, evolutionary operators, adapters to libraries."""
