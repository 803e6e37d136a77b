"""Every run of the suite tries the same examples: a failure is the code's, and comes back until it is mended."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")
