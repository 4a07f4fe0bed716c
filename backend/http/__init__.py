"""What all endpoints share: how requests are read, what they are given, how answers, errors and pages are written."""
