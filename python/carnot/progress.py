"""How far long work is: told to a function, or shown as a bar."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Any, Optional, Union

# A function of the fraction done, which stops the work where it returns False; True for a bar.
Progress = Union[Callable[[float], Optional[bool]], bool, None]


@contextlib.contextmanager
def watched(progress: Progress) -> Iterator[Optional[Callable[[float], Optional[bool]]]]:
    """What is called with the fraction done, while the work lasts."""
    if progress is None or progress is False:
        yield None
    elif progress is not True:
        if not callable(progress):
            raise ValueError(f"progress {progress!r}: accepted: a function, True or None")
        yield progress
    else:
        with _bar() as tell:
            yield tell


@contextlib.contextmanager
def _bar() -> Iterator[Callable[[float], Optional[bool]]]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        with _plain_bar() as tell:
            yield tell
        return
    form = "{l_bar}{bar}| {elapsed}<{remaining}"
    with tqdm(total=100, bar_format=form, leave=False) as bar:

        def tell_bar(fraction: float) -> None:
            bar.update(100 * fraction - bar.n)

        yield tell_bar


@contextlib.contextmanager
def _plain_bar() -> Iterator[Callable[[float], Optional[bool]]]:
    shown: Any = sys.stderr if sys.stderr is not None and sys.stderr.isatty() else None

    def tell(fraction: float) -> None:
        if shown is not None:
            shown.write(f"\r{100 * fraction:3.0f} %")
            shown.flush()

    try:
        yield tell
    finally:
        if shown is not None:
            shown.write("\r     \r")
            shown.flush()
