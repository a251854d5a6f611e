"""What game engines and renderers load."""
from . import _envmap
from ._arguments import Number, Path, Progress, Whole, public
from ._map import AnyMap, core_of
from ._words import Depth, Quality


@public
def engines() -> list[str]:
    """Returns the names of the engines and renderers that bake() knows.

    Returns
    -------
    list of str

    Examples
    --------
    >>> import envmap
    >>> "three" in envmap.engines()
    True
    """
    return _envmap.engines()  # type: ignore[no-any-return]


@public
def bake(map: AnyMap, engine: str, folder: Path, *, quality: Quality = "normal", size: Whole | None = None,
         chain_size: Whole | None = None, max_error: Number | None = None, exposure: Number = 0.0, depth: Depth | None = None,
         clamp: bool = False, force: bool = False, suns: bool = False, progress: Progress = None) -> list[str]:
    """Writes the folder that an engine loads, whole or not at all.

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used.
    engine : str
        One of engines().
    folder : str or os.PathLike
        Where to write. It is made where it is missing.
    quality : str, optional
        'draft', 'normal' (default) or 'high': sizes and error.
    size : int, optional
        Height of a face of the background in texels. Default: by quality.
    chain_size : int, optional
        Height of a face of the prefiltered chain, 1 to 4096. Default: by engine and quality.
    max_error : float, optional
        Bound of the error of every texel, file rounding included. Default: by quality.
    exposure : float, optional
        In stops, -100 to 100 (default: 0).
    depth : str, optional
        Of the files, where the engine leaves a choice.
    clamp : bool, optional
        Clamp values that files cannot hold (default: False: they are an error).
    force : bool, optional
        Replace files that are read-only (default: False).
    suns : bool, optional
        Take the lights that lights() finds out of the maps, and write them as lights of the engine (default: False).
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    list of str
        The names of the files.

    Raises
    ------
    UsageError
        The engine is unknown, or a value is out of its range.
    AccuracyError
        A file cannot hold the map within max_error.
    OutputError
        The folder cannot be written.

    Examples
    --------
    >>> import envmap
    >>> files = envmap.bake(envmap.generate("sky", size=32), "three", "lights", quality="draft")
    >>> "README.txt" in files
    True
    """
    names: list[str] = _envmap.bake(core_of(map), engine, folder, quality, size, chain_size, max_error, exposure, depth, clamp, force,
                                    suns, progress)
    return names


@public
def limit_threads(count: Whole) -> None:
    """Limits the threads of all calls together.

    Parameters
    ----------
    count : int
        At most so many, 0 to 1024; 0: one for each core again.

    Raises
    ------
    UsageError
        The count is out of its range.

    Examples
    --------
    >>> import envmap
    >>> envmap.limit_threads(0)
    """
    _envmap.limit_threads(count)
