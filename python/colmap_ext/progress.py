"""What the program says of its progress, and how it is shown."""

import contextlib
import importlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Callable, Optional, Union

# "Walking rays ... 12.3 s" or "... 1 min 02 s" ends a stage, "Walking rays ... 40 %"
# is on the way.
_STAGE = re.compile(
    r"(\S.*) \.\.\. (?:(?P<percent>\d+) %.*"
    r"|(?:(?P<minutes>\d+) min )?(?P<seconds>[\d.]+) s\s*$)")
_ITERATION = re.compile(r"(\S.*), iteration (\d+): energy (\S+), ZNCC (\S+), step (\S+) px")


@dataclass(frozen=True)
class Progress:
    """A stage that is on the way or has ended, or an iteration of the refinement.

    stage: "Walking rays", or of an iteration the size of the images: "1/4 size".
    share: of the stage that is done, 0 ... 1; None for an iteration.
    seconds: that the stage took; None before its end.
    iteration: its number within the level, from 0 on, and after it:
    energy: the photometric energy; lower is better.
    zncc: mean correlation of the images, -1 ... 1.
    step: mean motion of the vertices, pixels of these images.
    """

    stage: str
    share: Optional[float] = None
    seconds: Optional[float] = None
    iteration: Optional[int] = None
    energy: Optional[float] = None
    zncc: Optional[float] = None
    step: Optional[float] = None

    def __str__(self) -> str:
        if self.iteration is not None:
            return (f"{self.stage}, iteration {self.iteration}: ZNCC {self.zncc:.4f}, "
                    f"step {self.step:.3f} px")
        if self.seconds is not None:
            return f"{self.stage} ... {self.seconds:.1f} s"
        return f"{self.stage} ... {100 * (self.share or 0):.0f} %"


ProgressCallback = Callable[[Progress], object]


def parse_progress(line: str) -> Optional[Progress]:
    """The progress that a line of the program's output shows; None if it is another."""
    if iteration := _ITERATION.match(line):
        return Progress(iteration[1], iteration=int(iteration[2]),
                        energy=float(iteration[3]), zncc=float(iteration[4]),
                        step=float(iteration[5]))
    if stage := _STAGE.match(line):
        if stage["percent"]:
            return Progress(stage[1], int(stage["percent"]) / 100)
        return Progress(stage[1], 1.0,
                        60 * int(stage["minutes"] or 0) + float(stage["seconds"]))
    return None


def _print(progress: Progress) -> None:
    print(progress, flush=True)


@contextlib.contextmanager
def show_progress(progress: Union[bool, ProgressCallback]
                  ) -> Iterator[Optional[ProgressCallback]]:
    """The function to call; True shows a bar of tqdm, or prints lines without tqdm."""
    if progress is not True:
        yield progress or None
        return
    try:
        tqdm = importlib.import_module("tqdm.auto").tqdm
    except ImportError:
        yield _print
        return
    with tqdm(total=100, bar_format="{percentage:3.0f}% |{bar}| {elapsed} {desc}") as bar:
        def update(shown: Progress) -> None:
            if shown.share is not None:
                bar.n = round(100 * shown.share)
            elif bar.n == 100:  # An iteration belongs to the stage after the last one.
                bar.n = 0
            bar.set_description_str(str(shown))
        yield update
