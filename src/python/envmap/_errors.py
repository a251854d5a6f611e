"""Errors: one line, the file at fault, and what would help in the words of these functions."""
import errno
import os
from typing import Literal

Code = Literal["usage", "input", "output", "renderer", "accuracy"]


class Error(RuntimeError):
    """Base class of all errors of this module. The text is one line.

    Attributes
    ----------
    code : str
        'usage', 'input', 'output', 'renderer' or 'accuracy'.
    file : str or None
        The file at fault. The text begins with it.
    remedy : str
        A word for what would avoid the error, such as 'drop_channels' (see envmap/base/error.h); 'none' if nothing is known.
    field : str or None
        The argument whose value is out of its range or of a wrong type.
    """

    code: Code
    file: str | None = None
    remedy: str = "none"
    field: str | None = None

    def __str__(self) -> str:  # OSError would add errno and the file's name.
        return str(self.args[0]) if self.args else ""


class UsageError(Error, ValueError):
    """What was asked makes no sense."""

    code: Code = "usage"


class ArgumentError(UsageError, TypeError):
    """An argument is unknown, missing or of a wrong type."""


class _FileError(Error, OSError):
    # OSError keeps these two where pickle does not look.
    def __reduce__(self) -> tuple[object, ...]:
        return type(self), self.args, {**vars(self), "errno": self.errno, "filename": self.filename}


class InputError(_FileError):
    """An input cannot be read, or is not what it claims to be. errno is set where the system refused."""

    code: Code = "input"


class OutputError(_FileError):
    """An output cannot be written. Nothing was left behind."""

    code: Code = "output"


class RendererError(Error):
    """There is nothing to draw with."""

    code: Code = "renderer"


class AccuracyError(Error):
    """The error limit that was asked for cannot be met."""

    code: Code = "accuracy"


# The classes that `except FileNotFoundError` and its like catch.
class InputNotFoundError(InputError, FileNotFoundError): ...
class InputPermissionError(InputError, PermissionError): ...
class InputIsFolderError(InputError, IsADirectoryError): ...
class OutputNotFoundError(OutputError, FileNotFoundError): ...
class OutputPermissionError(OutputError, PermissionError): ...
class OutputIsFolderError(OutputError, IsADirectoryError): ...


_KINDS: dict[tuple[str, int | None], type[Error]] = {
    ("input", errno.ENOENT): InputNotFoundError, ("input", errno.EACCES): InputPermissionError,
    ("input", errno.EPERM): InputPermissionError, ("input", errno.EISDIR): InputIsFolderError,
    ("output", errno.ENOENT): OutputNotFoundError, ("output", errno.EACCES): OutputPermissionError,
    ("output", errno.EPERM): OutputPermissionError, ("output", errno.EISDIR): OutputIsFolderError,
    ("usage", None): UsageError, ("input", None): InputError, ("output", None): OutputError,
    ("renderer", None): RendererError, ("accuracy", None): AccuracyError}

# What would help, by the library's word for it.
_ADVICE = {
    "choose_projection": ": say which by projection=", "leave_out_layout": ": leave out layout=",
    "leave_out_from_layout": ": leave out layout=", "leave_out_face": ": leave out {face}",
    "drop_channels": ": drop_channels=True leaves them behind", "choose_space": ": say which by space=",
    "choose_faces": ": say which by faces=", "choose_format": ", or say format=", "choose_plus_z": ": forward='+z'",
    "clamp_or_deepen": ": depth='float' holds them, or say clamp=True",
    "clamp_or_brighten": ": depth='float' holds them, or say clamp=True",
    "clamp_or_darken": ": a floating-point format holds them, or say clamp=True",
    "clamp_or_dim": ": say clamp=True", "clamp_or_light_up": ": say clamp=True", "force": ": force=True replaces it",
    "make_levels": ": mipmap() makes levels anew", "make_cube": ": convert(to='cube') makes one",
    "take_base": ": headroom=0 reads the picture without its gain map", "make_all_levels": ": mipmap() makes them",
    "limit_memory": ": max_memory= keeps them in a scratch file", "allow_pixels": ": max_pixels= allows more",
    "choose_layer": ": say which by layer="}

_NUMBERS = (errno.ENOENT, errno.EACCES, errno.EPERM, errno.EISDIR, errno.ENOTDIR, errno.ENOSPC, errno.EROFS, errno.EFBIG, errno.EIO,
            errno.ENAMETOOLONG, errno.ELOOP, errno.EMFILE, errno.EDQUOT)
_PHRASES = (("no such file", errno.ENOENT), ("no such folder", errno.ENOENT), ("is a folder", errno.EISDIR), *((os.strerror(n), n) for n in _NUMBERS))


def _errno_of(message: str) -> int | None:
    return next((number for phrase, number in _PHRASES if phrase in message), None)


def error_of(code: Code, message: str, remedy: str, file: str | None, field: str | None) -> Error:
    """Returns the exception for an error of the library."""
    repair = ": read(repair=True) replaces them" if file else ": envmap.repair() replaces them"
    number = _errno_of(message) if code in ("input", "output") else None
    advice = repair if remedy == "repair" else _ADVICE.get(remedy, "")
    error = _KINDS.get((code, number), _KINDS[code, None])((message + advice).replace("\n", " "))
    error.file, error.remedy, error.field = file, remedy, field
    if isinstance(error, OSError):
        error.errno, error.filename = number, file  # type: ignore[assignment]
    return error
