"""What the option dataclasses of options.py have in common."""

import dataclasses
import math
import numbers
import os
from collections.abc import Mapping, Sequence
from typing import (TYPE_CHECKING, Annotated, Any, Literal, Optional, Union, get_args,
                    get_origin, get_type_hints)

StrPath = Union[str, os.PathLike[str]]


@dataclasses.dataclass(frozen=True)
class Range:
    """The finite numbers that an option takes."""

    lower: float
    upper: float = math.inf
    also: Optional[float] = None  # a value with another meaning

    def __contains__(self, number: float) -> bool:
        return self.lower <= number <= self.upper or number == self.also

    def __str__(self) -> str:
        text = f"{self.lower} " + (
            "or more" if self.upper == math.inf else f"... {self.upper}")
        return text if self.also is None else f"{text}, or {self.also}"


def _fits(value: Any, hint: Any) -> bool:
    """Whether the value has the type, and is in the type's range."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Union:
        return any(_fits(value, argument) for argument in arguments)
    if origin is Annotated:
        return _fits(value, arguments[0]) and value in arguments[1]
    if origin is Literal:
        return isinstance(value, str) and value in arguments
    if origin is Sequence:
        return (isinstance(value, Sequence) and len(value) > 0
                and all(_fits(item, arguments[0]) for item in value))
    if hint in (int, float):
        kind = numbers.Integral if hint is int else numbers.Real
        return (isinstance(value, kind) and not isinstance(value, bool)
                and math.isfinite(float(value)))
    return isinstance(value, origin or hint)


def _describe(hint: Any) -> str:
    """The values that a type stands for, in the words of the program."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Union:
        return ", or ".join(_describe(argument) for argument in arguments)
    if origin is Annotated:
        return f"{_describe(arguments[0])}, {arguments[1]}"
    if origin is Literal:
        *words, last = arguments
        return f"{', '.join(words)} or {last}" if words else str(last)
    if origin is Sequence:
        return "numbers"
    return {int: "a whole number", float: "a number", bool: "True or False",
            str: "a text", type(None): "None"}.get(hint, "a path")


class BaseOptions:
    """The options of a command. Misspelled attributes raise AttributeError."""

    if not TYPE_CHECKING:  # It would allow all names.
        def __setattr__(self, name: str, value: Any) -> None:
            if not hasattr(type(self), name):
                raise AttributeError(f"{type(self).__name__} has no option {name}")
            super().__setattr__(name, value)

    def check(self) -> None:
        """Raises ValueError if an option is of another type or out of its range;
        the message names the option and the range."""
        hints = get_type_hints(type(self), include_extras=True)
        for name, value in self.todict().items():
            if not _fits(value, hints[name]):
                raise ValueError(f"{type(self).__name__}.{name} is {value!r}; it has "
                                 f"to be {_describe(hints[name])}")

    def todict(self) -> dict[str, Any]:
        """The values of all options by name."""
        return dict(vars(self))

    def mergedict(self, values: Mapping[str, Any]) -> None:
        """Sets options by name. Raises AttributeError for a name that is unknown."""
        for name, value in values.items():
            setattr(self, name, value)

    def summary(self) -> str:
        """The values of all options, one on each line."""
        return "\n".join([f"{type(self).__name__}:"] + [
            f"    {name} = {value!r}" for name, value in self.todict().items()])

    def given(self) -> dict[str, Any]:
        """The options that differ from their default."""
        return {name: value for name, value in self.todict().items()
                if value != getattr(type(self), name)}
