"""Random values of the options that a program lists in its help."""

import importlib.machinery
import importlib.util
import pathlib
import re

# What large (or small) values cost is asked for: the range that is tried.
COSTLY = {
    "iterations": (None, 2), "levels": (None, 3), "turntable": (None, 3),
    "width": (None, 200), "height": (None, 200), "num_tiles": (None, 4),
    "max_face_area": (2, None), "spacing": (1e-3, None),
    "observability_box": (None, None),
}

WILD = ["nan", "inf", "-inf", "infinity", "1e999", "1e308", "-1e308", "1e-308",
        "1e-20", "1e20", "-0", "0x10", "1e9", "2147483647", "2147483648",
        "-2147483648", "4294967296", "99999999999999999999", "", " ", "abc",
        "1,2", "½", "1 ", " 1", "+1", "true", "no", "1e-3", "5.5", "-5", "-2",
        "1;2", "\x01", "'", "%s%n", "a" * 300]


def read_options(program, command):
    """{name: (default, range, help)} of a command's options, without their
    dashes."""
    path = pathlib.Path(__file__).resolve().parents[2] / "scripts/option_tables"
    loader = importlib.machinery.SourceFileLoader("option_tables", str(path))
    module = importlib.util.module_from_spec(
        importlib.util.spec_from_loader("option_tables", loader))
    loader.exec_module(module)
    options = {name[2:]: tuple(rest) for name, *rest in
               module.read_options(program, command) if name.startswith("--")}
    for name, (*_, text) in options.items():
        other = re.match(r"is --([\w.]+)", text)
        if other:
            options[name] = options[other[1]]
    return options


def _number(text):
    try:
        return float(text)
    except ValueError:
        return None


def _clamped(name, text):
    """Within what the option may cost here; not a number: as it is."""
    low, high = COSTLY.get(name.split(".")[-1], (None, None))
    number = _number(text)
    if number is None:
        return text
    if low is not None and 0 < number < low:
        return str(low)
    if high is not None and high < number < 2 ** 31:
        return str(high)
    return text


def _near(rng, default):
    """A number that may stand for the default."""
    if default in ("0", "1") and rng.random() < 0.7:
        return rng.choice("01")
    value = _number(default)
    numbers = [value, value * rng.uniform(0.1, 1), value * rng.uniform(1, 4), 0,
               1, -1, 2, 3, value + 1, rng.uniform(0, 1), value * 10]
    number = rng.choice(numbers)
    if "." not in default and rng.random() < 0.8:
        number = round(number)
    return f"{number:.6g}"


def _within(numbers, text):
    """The number, or the end of its range that it lies beyond: "0 ... 1",
    "0 or more", either perhaps with ", or -1"."""
    ends = [_number(word) for word in re.findall(r"[-+.\de]+\d|\d", numbers)]
    ends = [end for end in ends if end is not None]
    number = _number(text)
    if not ends or number is None or ("or -1" in numbers and number == -1):
        return text
    if number < ends[0]:
        return f"{ends[0]:.6g}"
    if "..." in numbers and number > ends[1]:
        return f"{ends[1]:.6g}"
    return text


def draw_value(rng, name, default, numbers, text):
    """A value of an option that is no path, most often a proper one."""
    if rng.random() < 0.06:
        return _clamped(name, rng.choice(WILD))
    words = re.search(r"\{([^}]*)\}", text)
    if words:
        return rng.choice(re.split(r",\s*", words[1]))
    if "," in default:
        return ",".join(_near(rng, part) for part in default.split(","))
    if _number(default) is not None:
        value = _near(rng, default)
        return _clamped(name, value if rng.random() < 0.1
                        else _within(numbers, value))
    words = re.findall(r"\w+(?=,)|(?<= or )\w+", text)
    return rng.choice(words + [default or "x"])
