"""Light of maps: prefiltering, spherical harmonics, irradiance, lookups, tables of the split sum."""
import dataclasses
from typing import Annotated, Any

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _envmap
from ._arguments import Number, Parameter, Progress, Table, Unfit, Whole, public
from ._errors import UsageError
from ._map import AnyMap, Map, as_map, core_of, map_of
from ._words import Forward, Lobe, Method, Projection, ShBasis, Window

# ---- prefilter ------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Prefiltered:
    """What prefilter() made, and how.

    Attributes
    ----------
    map : Map
        One level, or a chain.
    method : str
        'exact', 'treecode', 'prefix-sums' or 'multilevel': that of most texels; 'area' or 'nearest' of a mirror.
    error : float
        The largest bound of the error of a texel; 0 of exact sums.
    exact : int
        Texels that were summed exactly.
    lobe : str
        The lobe that was asked for; 'table' of a table.
    roughness, exponent : list of float or None
        The parameter of each level.
    """

    map: Map
    method: str
    error: float
    exact: int
    lobe: str
    roughness: list[float] | None
    exponent: list[float] | None


@public
def prefilter(map: AnyMap, lobe: Lobe = "diffuse", *, exponent: Parameter | None = None, roughness: Parameter | None = None,
              table: Table | None = None, to: Projection = "cube", size: Whole | None = None, method: Method = "auto", max_error: Number = 1e-3,
              scale: Number | None = None, forward: Forward = "+z", progress: Progress = None) -> Prefiltered:
    """Integrates a map with the lobe of a material, for each direction. Every texel is within max_error.

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used.
    lobe : str, optional
        'diffuse' (default), 'phong', 'ggx', 'blinn-phong' or 'charlie'.
    exponent : float or list, optional
        Of phong and blinn-phong, 0 to 1e9. A list makes a mip chain: a level for each, half the size of the one before.
    roughness : float or list, optional
        Perceptual roughness of ggx and charlie, 0 to 1. A list makes a chain: see level_roughnesses().
    table : str, os.PathLike or array, optional
        A lobe in the place of `lobe`: a file, as --lobe-table of envmap-prefilter(1) takes it, or an array (n, 2) of cosines and values.
    to : str, optional
        Projection of the result (default: 'cube').
    size : int, optional
        Height of a face of the first level in texels. Default: 64 of diffuse, else the density of the source.
    method : str, optional
        'auto' (default, the fastest), 'exact', 'treecode', 'prefix-sums' or 'multilevel'.
    max_error : float, optional
        Bound of the error of every texel, relative to it (default: 0.001).
    scale : float, optional
        Factor on the integral. Default: white stays 1.
    forward : str, optional
        World axis at the centre of the result (default: '+z').
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    Prefiltered

    Raises
    ------
    UsageError
        A value is out of its range, or the lobe lacks its parameter, or both a lobe and a table are given.
    InputError
        The map holds NaN, infinite or negative radiance, or the file holds no table.

    Examples
    --------
    >>> import envmap
    >>> sky = envmap.generate("sky", size=32)
    >>> envmap.prefilter(sky, size=8).map
    <envmap.Map cube 8x8 x 6, forward +z, 1 level>
    >>> chain = envmap.prefilter(sky, "ggx", roughness=[0, 0.5, 1], size=16)
    >>> len(chain.map.levels), chain.error <= 1e-3
    (3, True)
    >>> envmap.prefilter(sky, table=[(1, 1), (0.9, 0)], size=16).lobe
    'table'
    """
    if table is not None and lobe != "diffuse":
        raise UsageError(f"prefilter() takes a lobe or a table: leave out lobe='{lobe}'")
    core, done_by, error, exact = _envmap.prefilter(core_of(map), lobe, exponent, roughness, table, to, size, method, max_error, scale,
                                                    forward, progress)
    return Prefiltered(map_of(core), done_by, error, exact, lobe if table is None else "table", roughness, exponent)  # type: ignore[arg-type]


@public
def level_roughnesses(engine: str, size: Whole | None = None) -> list[float]:
    """Returns the roughness that an engine's shader looks for in each level of a chain.

    Parameters
    ----------
    engine : str
        One of engines() that uses a chain, such as 'filament'.
    size : int, optional
        Height of a face of the first level in texels. Default: the size that the engine uses.

    Returns
    -------
    list of float
        For prefilter(roughness=).

    Raises
    ------
    UsageError
        The engine is unknown or uses no chain.

    Examples
    --------
    >>> import envmap
    >>> envmap.level_roughnesses("filament", 16)[0]
    0.0
    """
    return _envmap.level_roughnesses(engine, size)  # type: ignore[no-any-return]


@public
def brdf_table(lobe: Lobe = "ggx", size: Whole = 128, *, progress: Progress = None) -> NDArray[numpy.float32]:
    """Returns the other factor of the split sum.

    Parameters
    ----------
    lobe : str, optional
        'ggx' (default), or 'charlie': the albedo of sheen.
    size : int, optional
        Rows and columns, 1 to 1024 (default: 128).
    progress : function, optional
        Is called with the fraction done, rising to 1.

    Returns
    -------
    array of float32
        (size, size, 3): roughness by row, the smoothest first; cosine of the view direction by column. Red is the scale, green the bias.

    Raises
    ------
    UsageError
        The lobe has no table.

    Examples
    --------
    >>> import envmap
    >>> table = envmap.brdf_table(size=16)
    >>> table.shape, bool(table[0, -1, 0] > 0.9)
    ((16, 16, 3), True)
    """
    return _envmap.brdf_table(lobe, size, progress)  # type: ignore[no-any-return]


# ---- harmonics and irradiance ---------------------------------------------------------------------------------------


@public
def sh(map: AnyMap, order: Whole = 2, *, irradiance: bool = False, window: Window = "none",
       progress: Progress = None) -> NDArray[numpy.float64]:
    """Projects a map to real spherical harmonics.

    The basis is orthonormal with the polar axis +Y, without the Condon-Shortley phase. shader_sh() has the bases of engines.

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used.
    order : int, optional
        The largest degree l, 0 to 200 (default: 2).
    irradiance : bool, optional
        Multiply by the factors of the clamped cosine: pi, 2 pi / 3, pi / 4 ... (default: False).
    window : str, optional
        Reduces ringing: 'none' (default), 'hann', or 'auto', the weakest window that keeps irradiance above 0.
    progress : function, optional
        Is called with the fraction done, rising to 1.

    Returns
    -------
    array of float64
        ((order + 1)^2, 3), at l (l + 1) + m.

    Raises
    ------
    UsageError
        The order is out of its range.
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap
    >>> coefficients = envmap.sh(envmap.generate("constant", size=32))
    >>> coefficients.shape, round(float(coefficients[0, 0]), 4)       # sqrt(4 pi)
    ((9, 3), 3.5449)
    """
    return _envmap.sh(core_of(map), order, irradiance, window, progress)  # type: ignore[no-any-return]


@public
def shader_sh(map: AnyMap, basis: ShBasis = "three", *, window: Window = "auto", progress: Progress = None) -> NDArray[numpy.float64]:
    """Returns the nine colours that a shader takes for diffuse light.

    Parameters
    ----------
    map : Map or array
        The environment, in the axes of the engine's world. Level 0 is used.
    basis : str, optional
        'three' (default): LightProbe.sh.coefficients of three.js. 'ramamoorthi': L00, L1-1, L10, L11, L2-2, L2-1, L20, L21, L22 of
        Ramamoorthi and Hanrahan 2001, which three.js uses, too. Both are radiance: the shader multiplies by the factors of the cosine.
        'filament': IndirectLight::Builder::irradiance(3, sh), the factors before 1, y, z, x, xy, yz, 3z^2 - 1, zx and x^2 - y^2 of
        irradiance / pi. 'godot': light probes of Godot's LightmapGI, radiance / pi.
    window : str, optional
        Reduces ringing: 'auto' (default), the weakest that keeps irradiance above 0, 'hann' or 'none'.
    progress : function, optional
        Is called with the fraction done, rising to 1.

    Returns
    -------
    array of float64
        (9, 3)

    Raises
    ------
    UsageError
        The basis is unknown.
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap
    >>> white = envmap.generate("constant", size=32)
    >>> round(float(envmap.shader_sh(white, "filament")[0, 0]), 6)     # Irradiance / pi of white.
    1.0
    """
    return _envmap.shader_sh(core_of(map), basis, window, progress)  # type: ignore[no-any-return]


def _directions(given: object) -> NDArray[Any]:
    try:
        array = numpy.asarray(given)
    except ValueError:
        raise Unfit("directions, an array (..., 3)") from None
    if array.ndim == 0 or array.shape[-1] != 3 or array.dtype.kind not in "fiu":
        raise Unfit("directions, an array (..., 3)")
    return numpy.ascontiguousarray(array, numpy.float32 if array.dtype == numpy.float32 else numpy.float64)


AnyDirections = Annotated[ArrayLike, _directions]


@public
def irradiance(map: AnyMap, normals: AnyDirections) -> NDArray[numpy.float64]:
    """Returns the irradiance of surfaces: the integral of L max(0, n.l).

    Each normal takes a sum over all texels. For many normals use prefilter() and lookup().

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used, and NaN and infinite texels count as 0.
    normals : array (..., 3)
        World directions of any length.

    Returns
    -------
    array of float64
        (..., 3): pi times radiance where that is the same everywhere.

    Raises
    ------
    UsageError
        A normal is 0, NaN or infinite.

    Examples
    --------
    >>> import envmap
    >>> envmap.irradiance(envmap.generate("constant", size=64), (0, 1, 0)).round(4).tolist()
    [3.1416, 3.1416, 3.1416]
    """
    normals = numpy.asarray(normals, numpy.float64)
    return _envmap.irradiance(core_of(map), normals.reshape(-1, 3)).reshape(normals.shape)  # type: ignore[no-any-return]


# ---- lookup ---------------------------------------------------------------------------------------------------------

_AT_ONCE = 1 << 20  # Directions, between which Python handles its signals.


def _map_or_chain(given: object) -> Map | Prefiltered:
    return given if isinstance(given, Prefiltered) else as_map(given)


AnyChain = Annotated[Map | ArrayLike | Prefiltered, _map_or_chain]


def _levels(given: object) -> NDArray[numpy.float64]:
    try:
        array = numpy.asarray(given)
    except ValueError:
        raise Unfit("a number or an array of numbers") from None
    if array.dtype.kind not in "fiu":
        raise Unfit("a number or an array of numbers")
    return array.astype(numpy.float64)


Levels = Annotated[ArrayLike, _levels]


class Lookup:
    """Radiance by world direction: bilinear without seams, and linear between levels.

    A Lookup is prepared once for many calls. Threads may share it.

    Parameters
    ----------
    map : Map, array or Prefiltered
        The environment with its levels.

    Raises
    ------
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap, numpy
    >>> look = envmap.Lookup(envmap.prefilter(envmap.generate("sky", size=32), "ggx", roughness=[0, 0.5, 1], size=16))
    >>> normals = numpy.random.default_rng(1).normal(size=(1000, 3)).astype(numpy.float32)
    >>> look(normals, roughness=0.3).shape
    (1000, 3)
    """


    @public
    def __init__(self, map: AnyChain) -> None:
        self._of = map
        self._core = _envmap.Lookup((map.map if isinstance(map, Prefiltered) else map)._core)  # type: ignore[union-attr]

    @public
    def __call__(self, directions: AnyDirections, level: Levels = 0.0, *, roughness: Levels | None = None) -> NDArray[numpy.float32]:
        """Returns the radiance from directions: see envmap.lookup()."""
        given: NDArray[Any] = directions  # type: ignore[assignment]
        levels = numpy.asarray(level if roughness is None else self._levels_of(roughness))
        if levels.ndim > 0:
            try:
                levels = numpy.broadcast_to(levels, given.shape[:-1])
            except ValueError:
                raise UsageError(f"levels {levels.shape} do not fit directions {given.shape}") from None
        rows, levels = given.reshape(-1, 3), numpy.ascontiguousarray(levels.reshape(-1))
        look = self._core.floats if rows.dtype == numpy.float32 else self._core.doubles
        found = numpy.empty(rows.shape, numpy.float32)
        for k in range(0, len(rows), _AT_ONCE):
            some = slice(k, k + _AT_ONCE)
            look(rows[some], levels if len(levels) == 1 else levels[some], found[some])
        return found.reshape(given.shape)

    def _levels_of(self, roughness: Any) -> NDArray[numpy.float64]:
        known = self._of.roughness if isinstance(self._of, Prefiltered) else None
        if known is None or any(a >= b for a, b in zip(known, known[1:])):
            raise UsageError("roughness= needs what prefilter() made of rising roughnesses; level= takes any map")
        return numpy.interp(roughness, known, numpy.arange(len(known)))

    def __reduce__(self) -> tuple[Any, ...]:
        return Lookup, (self._of,)

    def __repr__(self) -> str:
        return f"<envmap.Lookup of {self._of!r}>"


@public
def lookup(map: AnyChain, directions: AnyDirections, level: Levels = 0.0, *, roughness: Levels | None = None) -> NDArray[numpy.float32]:
    """Returns the radiance from directions: bilinear without seams, and linear between levels.

    Lookup(map) is prepared once for many calls.

    Parameters
    ----------
    map : Map, array or Prefiltered
        The environment with its levels.
    directions : array (..., 3)
        World directions of any length, float32 or float64. (0, 0, 0) and NaN give black.
    level : float or array, optional
        Of the mip chain, 0 (default) is the largest; 1.5 is half way between levels 1 and 2. One for all directions, or one for each.
    roughness : float or array, optional
        Instead of `level`: the level that has this roughness in a chain of prefilter().

    Returns
    -------
    array of float32
        Linear radiance in the shape of `directions`.

    Raises
    ------
    UsageError
        Levels do not fit directions, or the map does not know its roughnesses.
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap
    >>> sky = envmap.generate("directions", size=64)           # (direction + 1) / 2
    >>> envmap.lookup(sky, [(0, 1, 0), (1, 0, 0)]).round(2).tolist()
    [[0.5, 1.0, 0.5], [1.0, 0.5, 0.5]]
    """
    return Lookup(map)(directions, level, roughness=roughness)
