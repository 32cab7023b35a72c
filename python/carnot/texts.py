"""Options as texts, in the program's own notation.

The program checks them, so that what is wrong is refused in its words, as ValueError. A text gives
a number back to its last bit.
"""

from __future__ import annotations

import numbers
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

# A number, or a text such as "pi/2".
Integer = Union[int, "np.integer[Any]"]
Real = Union[float, int, str, "np.floating[Any]", "np.integer[Any]"]
# A configuration: numbers, or one text "0,1,pi/2,0". None, or "*", is a free coordinate.
Configuration = Union[str, Sequence[Optional[Real]], npt.NDArray[Any]]


def number_text(option: str, value: Any) -> str:
    """A number, or a text that is one."""
    if isinstance(value, str):
        return value
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return str(int(value))
    if isinstance(value, (numbers.Real, np.floating)) and not isinstance(value, bool):
        return repr(float(value))
    raise ValueError(f"{option} {value!r}: is no number; accepted: a finite number")


def vector_text(option: str, value: Any) -> str:
    """Numbers in a row, None for one that is free."""
    if isinstance(value, str):
        return value
    accepted = "accepted: numbers in a row, or None for one that is free"
    ordered = isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, bytes)
    if not ordered or (isinstance(value, np.ndarray) and value.ndim == 0):
        raise ValueError(f"{option} {value!r}: is no row; {accepted}")
    items = list(value)
    if any(isinstance(item, (list, tuple, dict, set, np.ndarray)) for item in items):
        raise ValueError(f"{option}: has more than one dimension; {accepted}")
    return ",".join("*" if item is None else number_text(option, item) for item in items)


def option_texts(options: Mapping[str, Any], **flags: Any) -> dict[str, str]:
    """By the program's names, without what is None, and without flags that are False."""
    texts = {}
    for name, value in options.items():
        if value is not None:
            option = name.replace("_", "-")
            texts[option] = number_text(f"--{option}", value)
    for name, value in flags.items():
        option = name.replace("_", "-")
        if not isinstance(value, (bool, np.bool_)):
            raise ValueError(f"--{option} {value!r}: is no flag; accepted: True, False")
        if value:
            texts[option] = "1"
    return texts


Bounds = tuple[Optional[float], Optional[float]]
Limits = Union[Mapping[str, Bounds], Iterable[str], None]


def limit_texts(limits: Limits) -> list[str]:
    """'EXPRESSION in A:B' of {"EXPRESSION": (A, B)}, or of such texts."""
    if limits is None:
        return []
    if isinstance(limits, str):
        return [limits]
    if not isinstance(limits, (Mapping, Sequence)):
        raise ValueError(
            f"--limit {limits!r}: accepted: {{'EXPRESSION': (lower, upper)}}, or texts"
        )
    if not isinstance(limits, Mapping):
        return [str(limit) for limit in limits]
    texts = []
    for expression, bounds in limits.items():
        try:
            lower, upper = bounds
        except (TypeError, ValueError):
            raise ValueError(
                f"--limit {expression!r}: {bounds!r} is no pair; accepted: (lower, upper), None "
                "for a bound that is missing"
            ) from None
        ends = ["" if end is None else number_text("--limit", end) for end in (lower, upper)]
        texts.append(f"{expression} in {ends[0]}:{ends[1]}")
    return texts


def disc_texts(discs: Optional[Iterable[Any]]) -> list[str]:
    """'X,Y,R' of (x, y, radius)."""
    if discs is None:
        return []
    listed = isinstance(discs, (Sequence, np.ndarray)) and not isinstance(discs, (str, bytes))
    if not listed or not all(isinstance(disc, (str, Sequence, np.ndarray)) for disc in discs):
        raise ValueError(f"--disc {discs!r}: accepted: a list of (x, y, radius)")
    return [vector_text("--disc", disc) for disc in discs]


def parameter_texts(given: Optional[Mapping[str, Any]], more: Mapping[str, Any]) -> list[str]:
    """'NAME=VALUE'."""
    if given is not None and not isinstance(given, Mapping):
        raise ValueError(f"parameters {given!r}: accepted: {{NAME: VALUE}}")
    values = {**(given or {}), **more}
    return [f"{name}={number_text(f'--set {name}', value)}" for name, value in values.items()]
