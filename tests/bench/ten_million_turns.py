"""Ten million turns of a plain loop, run at the level of a module: the measure of a machine.

A loop in a function is about twice as fast, since its names are not looked up.
"""

s = 0
for i in range(10_000_000):
    s += i * i % 7
