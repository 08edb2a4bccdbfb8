"""The files .vis: which images see each point of a cloud or vertex of a mesh."""

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Union

from .base_options import StrPath

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


@dataclass
class Visibility:
    """Image indices by point, as flat arrays.

    offsets: [P + 1] int64, where each point's row starts; the last is the end.
    images: [offsets[-1]] uint32, positions in the order in which COLMAP registered
        the images, not image ids.
    """

    offsets: "NDArray[np.int64]"
    images: "NDArray[np.uint32]"

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, point: int) -> "NDArray[np.uint32]":
        """The images that see a point, [n] uint32."""
        if not -len(self) <= point < len(self):
            raise IndexError(point)
        point %= len(self)
        return self.images[self.offsets[point]:self.offsets[point + 1]]


def read_vis(path: StrPath) -> Visibility:
    """Reads a .vis as a Visibility.

    Raises ValueError if it is truncated or too long, OSError if it cannot be read.
    """
    import numpy as np  # pylint: disable=import-outside-toplevel

    with open(path, "rb") as file:
        data = file.read()
    words = np.frombuffer(data, "<u4", len(data) // 4)
    num_points = int.from_bytes(data[:8], "little")
    # Each point takes a word at least.
    if len(data) < 8 or len(data) % 4 != 0 or num_points > len(words) - 2:
        raise ValueError(f"{os.fspath(path)}: truncated or not a .vis")
    offsets = np.zeros(num_points + 1, np.int64)
    position = 2
    counts = words.data
    for point in range(num_points):
        if position >= len(words):
            raise ValueError(f"{os.fspath(path)}: truncated")
        count = counts[position]
        offsets[point + 1] = offsets[point] + count
        position += 1 + count
    if position != len(words):
        raise ValueError(f"{os.fspath(path)}: truncated, or longer than its points")
    is_image = np.ones(len(words), bool)
    is_image[:2] = False
    is_image[2 + offsets[:-1] + np.arange(num_points)] = False
    return Visibility(offsets, words[is_image].astype(np.uint32))


def write_vis(path: StrPath,
              visibility: "Union[Visibility, Iterable[ArrayLike]]") -> None:
    """Writes a Visibility, or a sequence of rows of image indices, as a .vis."""
    import numpy as np  # pylint: disable=import-outside-toplevel

    if not isinstance(visibility, Visibility):
        rows = [np.asarray(row, np.uint32) for row in visibility]
        offsets = np.concatenate([[0], np.cumsum([len(row) for row in rows])])
        visibility = Visibility(
            offsets.astype(np.int64),
            np.concatenate([np.zeros(0, np.uint32), *rows]))
    num_points = len(visibility)
    words = np.zeros(num_points + len(visibility.images), "<u4")
    is_image = np.ones(len(words), bool)
    starts = visibility.offsets[:-1] + np.arange(num_points)
    is_image[starts] = False
    words[starts] = np.diff(visibility.offsets)
    words[is_image] = visibility.images
    with open(path, "wb") as file:
        file.write(num_points.to_bytes(8, "little") + words.tobytes())
