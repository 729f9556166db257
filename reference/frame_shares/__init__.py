"""Where the time of one frame goes: twins of the compiled frame that read the processor's cycle counter between their parts.

The engine itself carries no clocks: a frame of 10 us would spend much of it on them, and on choosing whether to read them. A twin
is the same source compiled once more, with some of the kernels that it calls replaced by themselves and a clock around them.
"""
