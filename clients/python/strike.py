#!/usr/bin/env python3
"""Strike an object of a running ringdownd, with nothing but Python's standard library.

    python3 strike.py bell                    one strike
    python3 strike.py bell --roll 8           eight more, exactly 120 ms apart: timed bundles
    python3 strike.py bell --rain 1000        a thousand within a second, in one message

As a module:

    from strike import Ringdown
    daemon = Ringdown()
    daemon.strike("bell", point=(0.05, 0, 0.02), impulse=(-0.02, 0, 0))
    daemon.send("/object/bell/gain", 0.5)
    print(daemon.ask("/version"))
    daemon.strikes([(0, point, impulse, 0.0005, 0.01 * i) for i in range(500)])    many, in one message

Units are SI; points and impulses are in the object's own frame. docs/reference/protocol.md lists every address.
"""

import argparse
import socket
import struct
import sys
import time

NTP_EPOCH = 2208988800  # seconds from 1900 to 1970


def pad(data):
    """An OSC string: ended by a zero, padded with zeros to a multiple of four bytes."""
    return data + b"\0" * (4 - len(data) % 4)


def message(address, *arguments):
    """One OSC message as bytes; arguments are int, float, str or bytes."""
    tags, body = ",", b""
    for argument in arguments:
        if isinstance(argument, str):
            tags, body = tags + "s", body + pad(argument.encode())
        elif isinstance(argument, bytes):
            tags, body = tags + "b", body + struct.pack(">i", len(argument)) + argument + b"\0" * (-len(argument) % 4)
        elif isinstance(argument, int):
            tags, body = tags + "i", body + struct.pack(">i", argument)
        else:
            tags, body = tags + "f", body + struct.pack(">f", argument)
    return pad(address.encode()) + pad(tags.encode()) + body


def bundle(when, *messages):
    """Messages that happen together at `when`, in seconds since 1970 as time.time() returns it."""
    ntp = int((when + NTP_EPOCH) * 2**32)
    return b"#bundle\0" + struct.pack(">Q", ntp) + b"".join(struct.pack(">i", len(m)) + m for m in messages)


def parse(packet):
    """An answer of the daemon as a list: [address, argument, ...]."""

    def string(at):
        end = packet.index(b"\0", at)
        return packet[at:end].decode(), (end // 4 + 1) * 4

    address, at = string(0)
    tags, at = string(at)
    values = [address]
    for tag in tags[1:]:
        if tag == "s":
            value, at = string(at)
        else:
            (value,) = struct.unpack_from(">" + tag, packet, at)
            at += 4
        values.append(value)
    return values


class Ringdown:
    """A daemon on this computer, or on `host` if it listens there."""

    def __init__(self, host="127.0.0.1", port=7770):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect((host, port))

    def send(self, address, *arguments):
        self.socket.send(message(address, *arguments))

    def strike(self, name, point, impulse, contact_time=0.0002):
        self.send(f"/object/{name}/strike", *map(float, point), *map(float, impulse), contact_time)

    def strikes(self, strikes):
        """Many strikes in few messages, for simulators: (object's number, point, impulse, contact time, delay) each."""
        records = [struct.pack(">2i8f", number, -1, *p, *j, contact, delay) for number, p, j, contact, delay in strikes]
        for first in range(0, len(records), 1600):
            self.send("/strikes", b"".join(records[first : first + 1600]))

    def send_at(self, when, *messages):
        self.socket.send(bundle(when, *messages))

    def ask(self, address, *arguments, timeout=2.0):
        """Sends, and returns the next answer; raises OSError (TimeoutError, ConnectionRefusedError) without one."""
        self.send(address, *arguments)
        self.socket.settimeout(timeout)
        return parse(self.socket.recv(65536))


def main():
    parser = argparse.ArgumentParser(description="Strike an object of a running ringdownd.")
    parser.add_argument("object", nargs="?", default="bell")
    parser.add_argument("--port", type=int, default=7770)
    parser.add_argument("--roll", type=int, default=0, metavar="N", help="then N more strikes, 120 ms apart")
    parser.add_argument("--rain", type=int, default=0, metavar="N", help="then N on object 0 within a second, as one blob")
    options = parser.parse_args()

    daemon = Ringdown(port=options.port)
    point, impulse = (0.05, 0.0, 0.02), (-0.02, 0.0, 0.0)
    try:
        daemon.strike(options.object, point, impulse)
        start = time.time() + 0.3
        for i in range(options.roll):
            softer = [j * 0.85**i for j in impulse]
            strike = message(f"/object/{options.object}/strike", *point, *softer)
            daemon.send_at(start + 0.12 * i, strike)
        if options.rain:
            soft = [0.05 * j for j in impulse]
            daemon.strikes([(0, point, soft, 0.0005, i / options.rain) for i in range(options.rain)])
        answer = daemon.ask("/sync", 1)
    except OSError as error:
        sys.exit(f"no daemon answers on port {options.port} ({error}): start ringdownd first")
    if answer[0] == "/fail":
        sys.exit(answer[2])


if __name__ == "__main__":
    main()
