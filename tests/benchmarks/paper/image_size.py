"""The size of an image, from its header."""

import struct

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
JPEG_START = b"\xff\xd8"
JPEG_FRAMES = set(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


def read_image_size(path):
    """Width and height in px of a PNG, JPEG or binary PPM."""
    with open(path, "rb") as file:
        start = file.read(24)
        if start.startswith(PNG_SIGNATURE):
            return struct.unpack(">II", start[16:24])
        file.seek(2)
        if start.startswith(JPEG_START):
            return _read_jpeg_size(file, path)
        if start.startswith(b"P6"):
            return _read_ppm_size(file)
    raise ValueError(f"{path} is neither PNG nor JPEG nor PPM.")


def _read_jpeg_size(file, path):
    while True:
        marker = file.read(4)
        if len(marker) < 4 or marker[0] != 0xFF:
            raise ValueError(f"{path} ends before the size of the image.")
        length = struct.unpack(">H", marker[2:])[0]
        if marker[1] in JPEG_FRAMES:
            _, height, width = struct.unpack(">BHH", file.read(5))
            return width, height
        file.seek(length - 2, 1)


def _read_ppm_size(file):
    numbers = []
    while len(numbers) < 2:
        numbers += file.readline().split(b"#")[0].split()
    return int(numbers[0]), int(numbers[1])
