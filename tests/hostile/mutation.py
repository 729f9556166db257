"""Mutational fuzzing: copies of valid files, damaged by bytes and by the structure of their format; equal seeds, equal damage."""

import io
import json
import random
import re
import struct
import zipfile
from collections.abc import Callable

Rng = random.Random

TOKENS = (
    b"", b"nan", b"NaN", b"inf", b"-inf", b"Infinity", b"0", b"-0.0", b"-1", b"1e308", b"1e400", b"-1e-320", b"9" * 400,
    b"9" * 5000, b"1_0", b"0x10", b"1,5", b"true", b"null", b'"x"', b"{}", b"[]", b"\x00", b"\xff\xfe", "\u0661".encode(),
    "\U0001f9a4".encode(), b"2147483648", b"-9223372036854775809", b"18446744073709551616", b"..", b"../../x", b"%s%n", b"'",
    b'"', b"\\", b"a" * 300,
)
"""Words that readers of numbers and names trip over."""
WORDS = re.compile(rb"[-+.\w]+")
INTEGERS = tuple(struct.pack(kind, value) for kind, value in (
    ("<I", 0), ("<I", 1), ("<I", 0x7FFFFFFF), ("<I", 0xFFFFFFFF), ("<H", 0xFFFF), ("<q", -1), ("<q", 2**62), (">I", 0x7FFFFFFF),
    ("<d", float("nan")), ("<d", float("inf")), ("<d", 1e308), ("<f", float("nan")), ("<f", 3e38),
))
"""Replacements of counts, offsets and coordinates of binary formats."""
DEEP = 200_000
"""Levels of nesting that no recursive parser can follow."""
NESTED = (65, 200, 850)
"""Levels that a parser can follow, and the code after it perhaps not."""


def flip(data: bytes, rng: Rng) -> bytes:
    """Return some bytes changed."""
    found = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8, 64))):
        if found:
            found[rng.randrange(len(found))] = rng.randrange(256)
    return bytes(found)


def cut(data: bytes, rng: Rng) -> bytes:
    """Return the end cut off."""
    return data[: rng.randrange(len(data) + 1)]


def drop(data: bytes, rng: Rng) -> bytes:
    """Return a stretch left out."""
    begin, end = stretch(data, rng)
    return data[:begin] + data[end:]


def repeat(data: bytes, rng: Rng) -> bytes:
    """Repeat a stretch a few times."""
    begin, end = stretch(data, rng)
    return data[:end] + data[begin:end] * rng.choice((1, 2, 30)) + data[end:]


def insert(data: bytes, rng: Rng) -> bytes:
    """Return random bytes, or a word, in between."""
    at = rng.randrange(len(data) + 1)
    word = rng.choice(TOKENS) if rng.random() < 0.6 else rng.randbytes(rng.randrange(1, 40))
    return data[:at] + word + data[at:]


def word(data: bytes, rng: Rng) -> bytes:
    """Return a number or name replaced."""
    found = list(WORDS.finditer(data[:100_000]))
    if not found:
        return insert(data, rng)
    chosen = rng.choice(found)
    return data[: chosen.start()] + rng.choice(TOKENS) + data[chosen.end() :]


def count(data: bytes, rng: Rng) -> bytes:
    """Return four or eight bytes that may be a count, an offset or a coordinate."""
    value = rng.choice(INTEGERS)
    # headers, which hold most of the counts, are short and come first
    at = rng.randrange(max(1, min(len(data), 128 if rng.random() < 0.5 else len(data))))
    return data[:at] + value + data[at + len(value) :]


def lines(data: bytes, rng: Rng) -> bytes:
    """Return lines in another order, or with other ends."""
    found = data.split(b"\n")
    if rng.random() < 0.3:
        return rng.choice((b"\r", b"\r\n", b"\x0b", b"\x00")).join(found)
    a, b = rng.randrange(len(found)), rng.randrange(len(found))
    found[a], found[b] = found[b], found[a]
    return b"\n".join(found)


def extreme(data: bytes, rng: Rng) -> bytes:
    """Return content unlike the file: nothing, noise, another encoding, brackets without end, one endless line."""
    return rng.choice((
        lambda: b"", lambda: rng.randbytes(rng.randrange(1, 4000)), lambda: b"\xef\xbb\xbf" + data, lambda: data + data,
        lambda: b"\xff\xfe" + data.decode("latin-1").encode("utf-16-le"), lambda: b"\x00" * len(data),
        lambda: rng.choice((b"[", b'{"a":', b"a.", b"<a>", b"(")) * DEEP, lambda: data.replace(b"\n", b" "), lambda: data[::-1],
        lambda: b"1" * 300_000, lambda: b'"' + b"x" * 300_000 + b"," + data,
    ))()


BYTES: tuple[Callable[[bytes, Rng], bytes], ...] = (flip, cut, drop, repeat, insert, word, word, word, count, count, lines)


def stretch(data: bytes, rng: Rng) -> tuple[int, int]:
    """Return where a random stretch, more often a short one, begins and ends."""
    begin = rng.randrange(len(data) + 1)
    return begin, min(len(data), begin + rng.choice((1, 4, 16, 100, 2000)))


def damaged(data: bytes, rng: Rng) -> bytes:
    """Return a file damaged byte by byte, in one place or a few."""
    if rng.random() < 0.03:
        return extreme(data, rng)
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        data = rng.choice(BYTES)(data, rng)
    return data


def hostile_value(rng: Rng, deep: int = 2) -> object:
    """Return a value that JSON can hold and that a reader may not expect."""
    made: object = rng.choice((
        None, True, False, 0, -1, 1.5, -0.0, 1e308, 10**400, -(10**30), 2**63, float("nan"), float("inf"), "", "NaN",
        "-Infinity", "x", "a" * 300, "\ud800", "<script>", "../x", "\x00", "1e400", [], {}, [[]], [None], {"": None},
    ))
    if deep and rng.random() < 0.05:
        for _ in range(rng.choice(NESTED)):
            made = {"a": made} if rng.random() < 0.5 else [made]
        return made
    if deep and rng.random() < 0.2:
        return [hostile_value(rng, deep - 1) for _ in range(rng.randrange(4))]
    return made


def places(value: object) -> list[tuple[object, object]]:
    """Return (container, key) of everything below a value."""
    found: list[tuple[object, object]] = []
    open_ = [value]
    while open_:
        node = open_.pop()
        entries = list(node.items()) if isinstance(node, dict) else list(enumerate(node)) if isinstance(node, list) else []
        found += [(node, key) for key, _ in entries]
        open_ += [child for _, child in entries]
    return found


def damaged_json(data: bytes, rng: Rng) -> bytes:
    """Return a JSON file in which values were replaced, left out or moved; now and then damaged byte by byte."""
    if rng.random() < 0.3:
        return damaged(data, rng)
    value = json.loads(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        found = places(value)
        if not found:
            return damaged(data, rng)
        # those near the top are few, and most of the file's meaning
        node, key = rng.choice(found[: rng.choice((8, 40, len(found)))])
        replace_in(node, key, rng)
    try:
        return json.dumps(value).encode()
    except RecursionError:
        # nested values within nested values: the parser could not follow these either
        return damaged(data, rng)


def replace_in(node: object, key: object, rng: Rng) -> None:
    """Change one entry of a list or mapping."""
    assert isinstance(node, dict | list)
    if rng.random() < 0.2:
        del node[key]  # type: ignore[arg-type]
    elif rng.random() < 0.1 and isinstance(node, dict):
        node[rng.choice(("", "x", "\x00", "a" * 300))] = node.pop(key)
    else:
        node[key] = hostile_value(rng)  # type: ignore[call-overload]


def damaged_words(data: bytes, rng: Rng) -> bytes:
    """A table or an XML file in which words were replaced, so that it can still be parsed; now and then damaged byte by byte."""
    if rng.random() < 0.35:
        return damaged(data, rng)
    for _ in range(rng.choice((1, 1, 3))):
        data = rng.choice((word, word, word, lines))(data, rng)
    return data


def damaged_zip(data: bytes, rng: Rng) -> bytes:
    """An archive whose members were damaged before they were packed, so that its checksums hold; now and then damaged outside."""
    if rng.random() < 0.25:
        return damaged(data, rng)
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = [(member.filename, archive.read(member)) for member in archive.infolist()]
    for _ in range(rng.choice((1, 1, 3))):
        if not members:
            break
        place = rng.randrange(len(members))
        name, content = members[place]
        kind = rng.random()
        if kind < 0.15:
            del members[place]
        elif kind < 0.25:
            members[place] = rng.choice((name + "x", "x", "", "../x.npy", name.replace("@", "")))[:60], content
        elif kind < 0.3:
            members.append((f"{name}2", content))
        elif kind < 0.4:
            members[place] = name, rng.choice(members)[1]
        elif kind < 0.7:
            members[place] = name, header_damaged(content, rng)
        else:
            members[place] = name, damaged(content, rng)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, content in members:
            archive.writestr(name or "x", content)
    return packed.getvalue()


def header_damaged(content: bytes, rng: Rng) -> bytes:
    """Return an .npy file whose header gives another kind, shape or order than its data."""
    header = content[:128]
    for old, new in rng.sample((
        (b"<f8", b"<c8"), (b"<f8", b"|O8"), (b"<f8", b"<i8"), (b"<i8", b"<f8"), (b"<U", b"|V"), (b"|u1", b"|b1"), (b"(", b"["),
        (b"False", b"True "), (b"fortran", b"fortrax"), (b", 3)", b", 9)"), (b"(8,", b"(9,"), (b"),", b"0),"), (b"(", b"(-"),
        (b"shape", b"shapf"), (b"(", b"(99999999999,"),
    ), 2):
        header = header.replace(old, new, 1)
    return header + content[128:]


def damaged_glb(data: bytes, rng: Rng) -> bytes:
    """Return a binary glTF file whose JSON was damaged and whose lengths then fit again; now and then damaged byte by byte."""
    if rng.random() < 0.4 or len(data) < 20:
        return damaged(data, rng)
    length = struct.unpack("<I", data[12:16])[0]
    inner = damaged_json(data[20 : 20 + length], rng)
    inner += b" " * (-len(inner) % 4)
    rest = data[20 + length :]
    return data[:8] + struct.pack("<II", 20 + len(inner) + len(rest), len(inner)) + data[16:20] + inner + rest
