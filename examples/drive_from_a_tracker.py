"""A tracker in ten lines: sends the pose of one link 60 times a second to `avatarsim live --udp 9870 --ws 9871`.

Shows: goals by UDP and by WebSocket. It needs no avatarsim, and by UDP nothing but Python.
Run: python examples/drive_from_a_tracker.py palm --udp 9870, or --ws 9871
"""

import argparse
import json
import math
import socket
import time
from collections.abc import Callable, Sequence

HOST = "127.0.0.1"
CENTRE = (-0.05, 0.0, 0.95)
"""[m] over the table of the default scene."""


def drive(send: Callable[[str], object], link: str, frames: int = 1200, pause: float = 1.0 / 60.0) -> None:
    """Lead a link in a circle of 0.2 m about CENTRE, once in 240 frames of `pause` [s] each."""
    for frame in range(frames):
        turn = math.tau * frame / 240.0
        place = [CENTRE[0] + 0.2 * math.cos(turn), CENTRE[1] + 0.2 * math.sin(turn), CENTRE[2]]
        send(json.dumps({"links": {link: {"position": place}}}))
        time.sleep(pause)


def main(words: Sequence[str] | None = None, frames: int = 1200) -> None:
    """Drive by the port that the command line names."""
    parser = argparse.ArgumentParser(description="a tracker that leads a link round in a circle")
    parser.add_argument("link", help="a link of the live scene: palm, or avatar/link")
    way = parser.add_mutually_exclusive_group(required=True)
    way.add_argument("--udp", type=int, metavar="PORT", help="send datagrams")
    way.add_argument("--ws", type=int, metavar="PORT", help="send over a WebSocket")
    args = parser.parse_args(words)
    if args.udp is not None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
            drive(lambda message: end.sendto(message.encode(), (HOST, args.udp)), args.link, frames)
    else:
        from websockets.sync.client import connect

        with connect(f"ws://{HOST}:{args.ws}/tracker") as client:
            drive(client.send, args.link, frames)


if __name__ == "__main__":
    main()
