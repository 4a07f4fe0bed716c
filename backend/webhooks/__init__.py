"""Messages to other programs when a run ends: stored in an outbox, signed, sent with retries.

Source: Standard Webhooks 1.0 (standardwebhooks.com), whose libraries verify the signature. Start reading at
`backend.webhooks.dispatcher`.
"""
