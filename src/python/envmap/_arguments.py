"""Arguments of public functions: what each may be, and errors of one line where one is something else.

Annotations say what an argument may be, to type checkers and to @public alike: Annotated[type, check], where check returns the
value that the function gets, or raises Unfit.
"""
import difflib
import functools
import inspect
import operator
import os
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

import numpy
from numpy.typing import ArrayLike, NDArray

from ._errors import ArgumentError

F = TypeVar("F", bound=Callable[..., Any])


class Unfit(Exception):
    """A value is not what an argument may be. The text says what may: "a whole number"."""

    def __init__(self, words: str, hint: str = "") -> None:
        super().__init__(words)
        self.hint = hint


def shown(value: Any) -> str:
    """Returns a short description of a value: never what is in an array."""
    if value is None or isinstance(value, (bool, int, float)):
        return repr(value)[:40]
    if isinstance(value, str):
        return repr(value) if len(value) <= 40 else f"a str of {len(value)} characters"
    kind = type(value).__name__
    if isinstance(value, (numpy.ndarray, numpy.generic)):
        return f"{kind} {value.shape} of {value.dtype}" if value.shape else f"{kind} of {value.dtype}"
    return f"{kind} of {len(value)}" if isinstance(value, (tuple, list)) else kind


def _whole(value: Any, words: str, below: int) -> int:
    if isinstance(value, (bool, numpy.bool_)):
        raise Unfit(words)
    try:
        number = operator.index(value)
    except TypeError:
        raise Unfit(words) from None
    if not -below <= number < below:
        raise Unfit(words)
    return number


def whole(value: Any) -> int:
    return _whole(value, "a whole number below 2^31", 2**31)


def count(value: Any) -> int:
    number = _whole(value, "a whole number from 0 to 2^63", 2**63)
    if number < 0:
        raise Unfit("a whole number from 0 to 2^63")
    return number


def number(value: Any) -> float:
    if isinstance(value, (bool, numpy.bool_, str, bytes)) or numpy.ndim(value) != 0 or numpy.iscomplexobj(value):
        raise Unfit("a number")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise Unfit("a number") from None


def truth(value: Any) -> bool:
    if not isinstance(value, (bool, numpy.bool_)):
        raise Unfit("True or False")
    return bool(value)


def text(value: Any) -> str:
    if not isinstance(value, str):
        raise Unfit("a str")
    return str(value)


def numbers(value: Any) -> list[float]:
    if isinstance(value, (str, bytes, Mapping)) or numpy.ndim(value) != 1:
        raise Unfit("numbers")
    return [number(x) for x in value]


def three_numbers(value: Any) -> tuple[float, float, float]:
    try:
        x, y, z = numbers(value)
    except (Unfit, ValueError, TypeError):
        raise Unfit("three numbers") from None
    return x, y, z


def colour(value: Any) -> tuple[float, float, float]:
    """A number is all three channels."""
    try:
        return (number(value),) * 3 if numpy.ndim(value) == 0 else three_numbers(value)
    except Unfit:
        raise Unfit("a number or three numbers") from None


def one_or_more(value: Any) -> list[float]:
    """A number, or one for each level."""
    try:
        return [number(value)] if numpy.ndim(value) == 0 else numbers(value)
    except (Unfit, ValueError):
        raise Unfit("a number or a list of numbers") from None


def place(value: Any) -> str | tuple[float, float, float]:
    try:
        return str(value) if isinstance(value, str) else three_numbers(value)
    except Unfit:
        raise Unfit("a name or three numbers") from None


def file_name(value: Any) -> bytes:
    """A name of a file as the system takes it."""
    if isinstance(value, (bytes, bytearray)):
        raise Unfit("a str or an os.PathLike", ": os.fsdecode() makes a name of them")
    try:
        name = os.fspath(value)
    except TypeError:
        raise Unfit("a str or an os.PathLike") from None
    return encoded_name(name)


def lobe_table(value: Any) -> bytes | list[tuple[float, float]]:
    """A file, or cosines and values."""
    words = "a file or an array (n, 2) of cosines and values"
    if isinstance(value, (str, os.PathLike)):
        return file_name(value)
    try:
        rows = [numbers(row) for row in value]
    except (Unfit, ValueError, TypeError):
        raise Unfit(words) from None
    if isinstance(value, Mapping) or any(len(row) != 2 for row in rows):
        raise Unfit(words)
    return [(row[0], row[1]) for row in rows]


def encoded_name(name: str | bytes) -> bytes:
    try:
        encoded = os.fsencode(name)
    except UnicodeEncodeError:
        raise Unfit("a name that the file system can hold (it has a lone surrogate)") from None
    if b"\0" in encoded:
        raise Unfit("a name without NUL characters")
    return encoded


def told(value: Any) -> Any:
    if not callable(value):
        raise Unfit("a function of one number")
    return value


def texts(value: Any) -> dict[str, str]:
    if not isinstance(value, Mapping) or not all(isinstance(x, str) for pair in value.items() for x in pair):
        raise Unfit("a dict of str")
    return dict(value)


# What arguments are annotated with.
Whole = Annotated[int | numpy.integer[Any], whole]
Count = Annotated[int | numpy.integer[Any], count]
Number = Annotated[float | numpy.floating[Any] | numpy.integer[Any], number]
Numbers = Sequence[float] | NDArray[Any]
Triple = Annotated[Numbers, three_numbers]
Parameter = Annotated[float | numpy.floating[Any] | numpy.integer[Any] | Numbers, one_or_more]
Place = Annotated[str | Numbers, place]
Path = Annotated[str | os.PathLike[str], file_name]
Table = Annotated[str | os.PathLike[str] | ArrayLike, lobe_table]
Progress = Annotated[Callable[[float], object] | None, told]
Facts = Annotated[Mapping[str, str], texts]

_PLAIN: dict[Any, Callable[[Any], Any]] = {int: whole, float: number, bool: truth, str: text}


def _is_optional(annotation: Any) -> bool:
    return get_origin(annotation) in (Union, types.UnionType) and type(None) in get_args(annotation)


def _check_of(annotation: Any) -> Callable[[Any], Any] | None:
    """Returns what checks a value, or nothing where any will do."""
    if annotation in _PLAIN:
        return _PLAIN[annotation]
    if get_origin(annotation) is Literal:
        words = ", ".join(map(repr, get_args(annotation)))

        def word(value: Any) -> str:
            if not isinstance(value, str):
                raise Unfit(f"one of {words}")
            return str(value)  # Which words there are the library says.
        return word
    if get_origin(annotation) is Annotated:
        inner, check = get_args(annotation)[:2]
        return (lambda value: None if value is None else check(value)) if _is_optional(inner) else check
    if _is_optional(annotation):
        checks = [_check_of(a) for a in get_args(annotation) if a is not type(None)]
        check = checks[0] if len(checks) == 1 else None
        return (lambda value: None if value is None else check(value)) if check else None
    return None


def _misfit(name: str, parameters: Mapping[str, inspect.Parameter], kwargs: Mapping[str, object], reason: TypeError) -> ArgumentError:
    unknown = [k for k in kwargs if k not in parameters]
    if not unknown:
        return ArgumentError(f"{name}(): {reason}")
    near = difflib.get_close_matches(unknown[0], parameters, 1)
    names = ", ".join(k for k in parameters if k != "self")
    error = ArgumentError(f"{name}() has no argument {unknown[0]!r}: " + (f"did you mean {near[0]!r}?" if near else f"it has {names}"))
    error.field = unknown[0]
    return error


def checked(name: str, argument: str, check: Callable[[Any], Any], value: object) -> Any:
    """Returns what check() makes of an argument. @raises ArgumentError where it is unfit."""
    try:
        return check(value)
    except Unfit as unfit:
        error = ArgumentError(f"{name}(): {argument} must be {unfit}, not {shown(value)}{unfit.hint}")
    error.field = argument
    raise error


def public(function: F) -> F:
    """Checks the arguments of a function by their annotations, and makes it one of the package `envmap` in pickles and help."""
    signature = inspect.signature(function)
    parameters = signature.parameters
    takes_any = any(p.kind is p.VAR_KEYWORD for p in parameters.values())
    checks = {k: check for k, p in parameters.items() if p.kind is not p.VAR_KEYWORD and (check := _check_of(p.annotation))}
    name = "envmap." + function.__qualname__.removesuffix(".__init__")

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            given = signature.bind(*args, **kwargs)
        except TypeError as reason:
            raise _misfit(name, {} if takes_any else parameters, {} if takes_any else kwargs, reason) from None
        given.apply_defaults()
        for argument, check in checks.items():
            given.arguments[argument] = checked(name, argument, check, given.arguments[argument])
        return function(*given.args, **given.kwargs)

    call.__module__ = "envmap"
    # Types stand in the docstring: those of checkers are long.
    call.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=[p.replace(annotation=inspect.Parameter.empty) for p in parameters.values()], return_annotation=signature.empty)
    return call  # type: ignore[return-value]
