"""Ways in which files get damaged."""

import os
import struct

EXTREMES = [b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\0\0\xc0\x7f", b"\0\0\x80\x7f",
            b"\xff\xff\x7f\x7f", b"\0\0\0\0", b"\1\0\0\0", b"\xff\xff\xff\x7f",
            struct.pack("<f", 1e6), struct.pack("<f", -1e20),
            struct.pack("<d", float("nan")), struct.pack("<d", 1e300),
            struct.pack("<q", -1), struct.pack("<q", 1 << 40)]


def _remove(_, path):
    path.unlink()


def _empty(_, path):
    path.write_bytes(b"")


def _cut(rng, path):
    data = path.read_bytes()
    at = rng.choice([rng.randrange(len(data) + 1), max(0, len(data) - 1),
                     len(data) // 2, min(len(data), 8)])
    path.write_bytes(data[:at])


def _change(rng, path, piece):
    """Writes a piece over a random place, or one at the beginning."""
    data = bytearray(path.read_bytes())
    end = len(data) if rng.random() < 0.6 else min(len(data), 512)
    at = rng.randrange(end + 1)
    data[at:at + len(piece)] = piece
    path.write_bytes(data)


def _flip(rng, path):
    for _ in range(rng.choice([1, 1, 1, 5, 50])):
        _change(rng, path, bytes([rng.randrange(256)]))


def _overwrite(rng, path):
    for _ in range(rng.choice([1, 1, 5])):
        _change(rng, path, rng.choice(EXTREMES))


def _overwrite_numbers(rng, path):
    """At a place for numbers of 4 bytes, counted from the end."""
    data = bytearray(path.read_bytes())
    for _ in range(rng.choice([1, 3, 100])):
        at = len(data) - 4 * rng.randrange(1, len(data) // 4 + 2)
        if at >= 0:
            data[at:at + 4] = rng.choice(EXTREMES)[:4]
    path.write_bytes(data)


def _edit_text(rng, path):
    """Another number in place of one of the first bytes."""
    data = path.read_bytes()
    places = [i for i, byte in enumerate(data[:400]) if chr(byte).isdigit()]
    if places:
        at = rng.choice(places)
        piece = rng.choice([b"", b"9", b"0", b"-1", b"99999999999", b"nan"])
        data = data[:at] + piece + data[at + 1:]
    path.write_bytes(data)


def _append(rng, path):
    with open(path, "ab") as file:
        file.write(rng.randbytes(rng.choice([1, 4, 1000])))


def _repeat(rng, path):
    data = path.read_bytes()
    a, b = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    path.write_bytes(data[:b] + data[a:])


def _fill(rng, path):
    path.write_bytes(rng.randbytes(rng.choice([1, 16, 4096])))


def _make_folder(_, path):
    path.unlink()
    path.mkdir()


def _make_dangling(_, path):
    path.unlink()
    path.symlink_to("nowhere")


def _make_loop(_, path):
    path.unlink()
    path.symlink_to(path.name)


def _exchange(rng, path, others):
    """Takes the bytes of another file."""
    path.write_bytes(rng.choice(others).read_bytes())


KINDS = [_remove, _empty, _cut, _cut, _flip, _flip, _overwrite, _overwrite,
         _overwrite_numbers, _overwrite_numbers, _edit_text, _edit_text, _append,
         _repeat, _fill, _make_folder, _make_dangling, _make_loop]


def damage(rng, path, others):
    """Damages a file. others: whose bytes it may get. Returns how, a text."""
    if others and rng.random() < 0.15:
        _exchange(rng, path, others)
        return f"exchange {path}"
    kind = rng.choice(KINDS)
    if os.path.getsize(path) == 0:
        kind = _fill
    kind(rng, path)
    return f"{kind.__name__[1:]} {path}"
