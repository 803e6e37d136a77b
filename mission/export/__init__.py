"""A plan in the files of other programs: what autopilots fly by themselves, and what maps show."""
