"""Builders that several folders of tests share: what each file is named after."""
