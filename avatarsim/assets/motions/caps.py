"""Caps of files from strangers: the most of each thing that a reader of motions takes, with its unit and its reason."""

MOST_BYTES = 2**28
"""Bytes of a file: half an hour of 75 joints at 60 Hz, as text. Read, it takes some four times as much memory."""

MOST_LINES = 4_000_000
"""Lines of a file: AMC has one for each bone and frame, CMU's longest 600,000. A line takes 50 bytes of memory at least."""

MOST_JOINTS = 512
"""Joints of a skeleton: hands and face included, recorded ones have up to 250. Pairs of links grow as its square."""

MOST_FRAMES = 1_000_000
"""Frames of a clip: more than two hours at 120 Hz."""

LONGEST_NAME = 200
"""Characters of a name: longer ones would fill the sentences that name them."""

LONGEST_LINE = 2**18
"""Characters of a line: six numbers of 80 characters for each of 512 joints."""

LARGEST_NUMBER = 1e9
"""Largest magnitude of a number in any unit of a file: angles of more turns, and places farther away, have lost their digits."""
