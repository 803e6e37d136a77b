"""Every run of the suite tries the same examples: a failure is the code's, never a slow machine's, and comes back."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
