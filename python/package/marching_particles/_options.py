"""The keyword arguments of a sampling, as the settings of the core."""

from __future__ import annotations

import json

from . import _core
from ._fields import integer, numbers

#: The settings of the core: for each its argument here, its name, the kind of its values and more.
SETTINGS = json.loads(_core.SETTINGS)

_SIZES = ("count", "spacing", "radius")


def settings_of(options):
    """The options that are given, as JSON for the core.

    Args:
        options: Values by the names of the keyword arguments; None where one is not given.

    Raises:
        ValueError: If a value is out of its range, or two of them exclude each other.
        TypeError: If a value is of a wrong type.
    """
    options = {name: value for name, value in options.items() if value is not None}
    sizes = [name for name in _SIZES if name in options]
    if len(sizes) > 1:
        raise ValueError(f"{' and '.join(sizes)} exclude each other: give one of them")
    settings, lengths, solid = {}, {}, {}
    # The argument that gave each setting.
    given = {}
    if "spacing" in options:
        spacing = options.pop("spacing")
        if isinstance(spacing, str):
            settings["radius_share"] = _share("spacing", spacing) / 2
        else:
            settings["radius"] = _length("spacing", spacing) / 2
        given["radius_share"] = "spacing"
    for setting in SETTINGS:
        name, argument = setting["name"], setting["argument"]
        if argument not in options or name in ("size_mode", "box_mode"):
            continue
        value = options.pop(argument)
        if name in _FLAGS:
            if value:
                kept = solid if name.startswith("box_") else settings
                kept[name] = _FLAGS[name]
                given[name] = argument
            continue
        given[name] = argument
        if name == "thickness":
            solid[name] = value if isinstance(value, str) else _number(argument, value, setting)
        elif setting["kind"] == "choice":
            if value not in setting["choices"]:
                known = ", ".join(map(repr, setting["choices"]))
                raise ValueError(f"{argument} is {value!r}, but must be one of {known}")
            settings[name] = value
        elif setting["kind"] == "integer":
            settings[name] = integer(argument, value, int(setting["least"]), int(setting["most"]))
        elif not setting["is_share"]:
            settings[name] = _number(argument, value, setting)
        elif isinstance(value, str):
            settings[name] = _share(argument, value)
        elif name == "radius_share":
            settings["radius"] = _length(argument, value)
        else:
            lengths[name] = _length(argument, value)
    if "count" in settings:
        settings["size_mode"] = "count"
    if options:
        raise TypeError(f"there is no argument {next(iter(options))!r}")
    return json.dumps({"settings": settings, "lengths": lengths, "solid": solid, "given": given})


#: The settings that are True or False here, with their values if True.
_FLAGS = {
    "sampling": "adaptive",
    "counting": "exactly",
    "box_faces": "closed",
    "box_cell": "periodic",
}


def _number(name, value, setting):
    number = float(numbers(name, value, (), "a number"))
    if not setting["least"] <= number <= setting["most"]:
        least, most = (f"{bound:g}" for bound in (setting["least"], setting["most"]))
        raise ValueError(f"{name} is {number:g}, but must lie between {least} and {most}")
    return number


def _share(name, text):
    """The share that a text such as "0.6%" says."""
    digits = text.strip()
    try:
        if digits[-1:] != "%":
            raise ValueError
        # Rounded once, like the same share in the library.
        return float(digits[:-1].strip() + "e-2")
    except ValueError:
        what = 'a length, or a share of the diagonal of the box such as "1%"'
        raise ValueError(f"{name} must be {what}, and not {text!r}") from None


def _length(name, value):
    length = float(numbers(name, value, (), "a number"))
    if length <= 0:
        raise ValueError(f"{name} is {length}, but must be positive")
    return length
