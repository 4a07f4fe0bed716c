"""What search methods share: local descents, clustering, evolutionary operators, adapters to libraries."""
