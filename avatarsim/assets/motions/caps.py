"""Caps of files from strangers: the most of each thing that a reader of motions takes, with its unit and its reason."""

MOST_BYTES = 2**28
"""Bytes of a file: an hour of a hundred joints at 120 Hz as text has half of it. More would fill a small machine's memory."""

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
