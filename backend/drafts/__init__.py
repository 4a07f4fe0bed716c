"""Campaigns that are being prepared and kept as they were typed."""
