"""Operations on maps: convert, mip levels, repair, comparison, facts, pictures, and texels of projections."""
import dataclasses
from typing import Annotated, Any

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _envmap
from ._arguments import Number, Progress, Triple, Whole, public
from ._map import AnyMap, Map, core_of, core_of_arrays, floats_of, map_of
from ._words import Filter, Forward, Lens, Mirror, Projection, Weights

Colour = tuple[float, float, float]
Index = tuple[int, int, int]


@public
def convert(map: AnyMap, to: Projection | None = None, *, size: Whole | None = None, filter: Filter | None = None, samples: Whole = 1,
            max_error: Number | None = None, rotate: Triple = (0, 0, 0), mirror: Mirror = "none", gain: Number = 1.0,
            forward: Forward | None = None, ball_distance: Number | None = None, ball_fov: Number | None = None,
            progress: Progress = None) -> Map:
    """Resamples a map to another projection, size or orientation.

    Parameters
    ----------
    map : Map or array
        The source. Level 0 is used.
    to : str, optional
        'latlong', 'cube', 'sphere', 'paraboloid', 'angular', 'octahedral' or 'equal-area'. Default: that of the source.
    size : int, optional
        Height of a face in texels, 1 to 65536. Default: the density of the source.
    filter : str, optional
        'nearest', 'bilinear', 'bicubic', 'trilinear', 'sat', 'ewa', 'area' or 'nearest-level'. Default: area for reduction, else bilinear.
    samples : int, optional
        N x N samples per texel for nearest, bilinear and bicubic, 1 to 64 (default: 1).
    max_error : float, optional
        Use the fastest filter whose error, measured in some texels against 'area', stays below this.
    rotate : three numbers, optional
        Yaw, pitch and roll in degrees (default: 0, 0, 0). The environment is rotated.
    mirror : str, optional
        Negate a world axis after the rotation: 'none' (default), 'x', 'y' or 'z'.
    gain : float, optional
        Factor on radiance (default: 1).
    forward : str, optional
        World axis at the centre of the result: '+z', '-z', '+x' or '-x'. Default: '+z', and that of the source where `to` is not given.
    ball_distance : float, optional
        The source is a photo of a mirror ball by a camera at this distance from its centre, in radii of the ball.
    ball_fov : float, optional
        The same by the angle that the ball spans at the camera, in degrees. What the ball hides gets the colours of its rim.
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    Map
        Of one level.

    Raises
    ------
    UsageError
        A value is out of its range.
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap
    >>> sky = envmap.generate("sky", size=64)
    >>> envmap.convert(sky, "cube", size=32, rotate=(90, 0, 0))
    <envmap.Map cube 32x32 x 6, forward +z, 1 level>
    """
    return map_of(_envmap.convert(core_of(map), to, size, filter, samples, max_error, rotate, mirror, gain, forward, ball_distance, ball_fov,
                                  progress))


@public
def mipmap(map: AnyMap, *, levels: Whole = 0, weights: Weights = "solid-angle") -> Map:
    """Returns the map with mip levels that preserve flux.

    Parameters
    ----------
    map : Map or array
        The source. Levels after the first are made from level 0.
    levels : int, optional
        How many, 0 to 32. Default: 0, down to one texel.
    weights : str, optional
        'solid-angle' (default), or 'uniform': the plain means of glGenerateMipmap.

    Returns
    -------
    Map

    Raises
    ------
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap
    >>> envmap.mipmap(envmap.generate("sky", "cube", 16))
    <envmap.Map cube 16x16 x 6, forward +z, 5 levels>
    """
    return map_of(_envmap.mipmap(core_of(map), levels, weights))


def _flawed_map(given: object) -> object:
    return given if isinstance(given, Map) else floats_of(given)


@public
def repair(map: Annotated[Map | ArrayLike, _flawed_map], projection: Projection | None = None, forward: Forward | None = None) -> Map:
    """Returns the map with its NaN, infinite and negative texels replaced.

    NaN and infinite texels become the mean of their sound neighbours. Negative channels become 0.

    Parameters
    ----------
    map : Map or array
        The source. All its levels are repaired.
    projection, forward : str, optional
        Of an array, as in Map.

    Returns
    -------
    Map

    Raises
    ------
    InputError
        No texel is sound.

    Examples
    --------
    >>> import envmap, numpy
    >>> a = numpy.ones((8, 16, 3))
    >>> a[2, 3] = numpy.nan
    >>> envmap.repair(a).array[2, 3].tolist()
    [1.0, 1.0, 1.0]
    """
    if isinstance(map, Map):
        source = Map(map, projection, forward)
    else:
        source = map_of(core_of_arrays([map], projection, forward, flawed=True))  # type: ignore[list-item]
    core, _ = _envmap.repair(source._core)
    return map_of(core, source.source)


@dataclasses.dataclass(frozen=True, repr=False)
class Difference:
    """How a map differs from a reference, weighted by solid angle. Of several levels the largest figures.

    Attributes
    ----------
    flux : three floats
        (flux a - flux b) / flux b by channel.
    rms : float
        sqrt(sum w |a-b|^2 / sum w |b|^2).
    max : float
        The largest |a-b| / max(|b|, 0.001 x mean of b).
    worst : three ints
        Face, row and column of the texel of max.
    worst_level : int
        The level of this texel.
    levels : list of Difference
        One for each level, the largest level first. Empty in these.
    """

    flux: Colour
    rms: float
    max: float
    worst: Index
    worst_level: int
    levels: list["Difference"]

    def __repr__(self) -> str:
        face, row, column = self.worst
        level = f" of level {self.worst_level}" if len(self.levels) > 1 else ""
        return (f"<envmap.Difference flux {' '.join(f'{x:.3g}' for x in self.flux)}, rms {self.rms:.3g}, max {self.max:.3g} at face {face}, "
                f"row {row}, column {column}{level}>")


def _difference(found: tuple[Any, ...]) -> Difference:
    flux, rms, largest, worst, level, levels = found
    return Difference(flux, rms, largest, worst, level, [_difference(one) for one in levels])


@public
def compare(a: AnyMap, b: AnyMap) -> Difference:
    """Compares map a with the reference b, level by level.

    Parameters
    ----------
    a, b : Map or array
        Both have the same projection, size, forward axis and number of levels.

    Returns
    -------
    Difference

    Raises
    ------
    UsageError
        The maps differ in projection, size, forward axis or number of levels.

    Examples
    --------
    >>> import envmap
    >>> sky = envmap.generate("sky", size=16)
    >>> darker = envmap.Map(sky.array * 0.5)
    >>> found = envmap.compare(darker, sky)
    >>> found.rms, found.flux
    (0.5, (-0.5, -0.5, -0.5))
    """
    return _difference(_envmap.compare(core_of(a), core_of(b)))


@dataclasses.dataclass(frozen=True)
class Info:
    """Facts about level 0 of a map. NaN, infinite and negative texels are left out.

    Attributes
    ----------
    projection, forward : str
        Of the map.
    size, levels : int
        Height of a face in texels, and the number of levels.
    minimum, maximum, mean : three floats
        Radiance by channel. The mean is weighted by solid angle.
    flux : three floats
        The sum of radiance x solid angle.
    solid_angle : float
        Of all texels, in steradians: 4 pi.
    darkest, brightest : float
        Luminance (Rec. 709): the least above 0, and the largest.
    brightest_direction : three floats
        World direction to the middle of the brightest region.
    brightest_index : three ints
        Face, row and column of its texel.
    brightest_value : three floats
        The radiance of this texel.
    brightest_texels : int
        Of the region: many where a light was clipped.
    irradiance : three floats
        Of a plane that faces `towards`: the integral of L cos.
    illuminance : float
        Its luminance: in lux where radiance is in candelas per square metre, or where the file says what radiance 1 is.
    flaws : int
        Texels that are NaN, infinite or negative, in all levels up to the first that has any.
    """

    projection: str
    size: int
    forward: str
    levels: int
    minimum: Colour
    maximum: Colour
    mean: Colour
    flux: Colour
    solid_angle: float
    darkest: float
    brightest: float
    brightest_direction: Colour
    brightest_index: Index
    brightest_value: Colour
    brightest_texels: int
    irradiance: Colour
    illuminance: float
    flaws: int


@public
def info(map: AnyMap, *, towards: Triple = (0, 1, 0)) -> Info:
    """Measures a map: flux, mean, brightest direction, illuminance.

    Parameters
    ----------
    map : Map or array
        The map. Level 0 is measured.
    towards : three numbers, optional
        Normal of the plane of `irradiance` and `illuminance` (default: up, (0, 1, 0)).

    Returns
    -------
    Info

    Raises
    ------
    UsageError
        towards is no direction.

    Examples
    --------
    >>> import envmap
    >>> white = envmap.info(envmap.generate("constant", size=64))
    >>> round(white.illuminance, 4), round(white.flux[0], 4)      # pi and 4 pi.
    (3.1416, 12.5664)
    """
    given: Any = map
    found = _envmap.measure(core_of(given), towards)
    flaws = core_of(given).flaws()
    white = given.source.white_luminance if given.source else None
    found["illuminance"] *= 1 if white is None else white
    return Info(projection=given.projection, size=given.size, forward=given.forward, levels=len(given.levels),
                flaws=sum(flaws[1:4]) if flaws else 0, **found)


@public
def photograph(map: AnyMap, *, towards: Triple = (0, 0, 1), fov: Number = 60.0, width: Whole = 640, height: Whole = 480,
               lens: Lens = "perspective", filter: Filter = "bilinear", samples: Whole | None = None, rotate: Triple = (0, 0, 0),
               gain: Number = 1.0, progress: Progress = None) -> NDArray[numpy.float32]:
    """Returns what a camera in the middle of the environment sees.

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used.
    towards : three numbers, optional
        World direction at the centre of the picture (default: (0, 0, 1)). +Y is up.
    fov : float, optional
        Vertical field of view in degrees (default: 60): below 180, of fisheyes up to 360.
    width, height : int, optional
        Of the picture in pixels (default: 640 and 480).
    lens : str, optional
        'perspective' (default), 'fisheye' (equidistant) or 'cylinder'.
    filter : str, optional
        'bilinear' (default), 'nearest' or 'bicubic'; of the perspective lens also 'nearest-level', 'trilinear', 'ewa' and 'area'.
    samples : int, optional
        N x N samples per pixel. Default: two for each texel of the source that a pixel spans.
    rotate : three numbers, optional
        Yaw, pitch and roll of the environment in degrees (default: 0, 0, 0).
    gain : float, optional
        Factor on radiance (default: 1).
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    array of float32
        (height, width, 3), linear radiance, rows from the top. envmap.png() makes a file of it.

    Raises
    ------
    UsageError
        A value is out of its range, or a cylinder spans more than one turn.

    Examples
    --------
    >>> import envmap
    >>> picture = envmap.photograph(envmap.generate("sky", size=64), towards=(0, 1, 0), fov=90, width=32, height=32)
    >>> picture.shape
    (32, 32, 3)
    """
    return _envmap.photograph(core_of(map), lens, fov, width, height, towards, filter, samples, rotate, gain, progress)  # type: ignore[no-any-return]


@public
def solid_angles(projection: Projection, size: Whole) -> NDArray[numpy.float64]:
    """Returns the solid angle of each texel of a face. Every face has the same.

    Parameters
    ----------
    projection : str
        Such as 'cube'.
    size : int
        Height of a face in texels, 1 to 65536.

    Returns
    -------
    array of float64
        (height, width), in steradians; 0 outside the disc of sphere, paraboloid and angular maps.

    Raises
    ------
    UsageError
        A value is out of its range.

    Examples
    --------
    >>> import envmap, numpy
    >>> round(6 * float(envmap.solid_angles("cube", 16).sum()) / numpy.pi, 9)
    4.0
    """
    return _envmap.solid_angles(projection, size)  # type: ignore[no-any-return]


@public
def directions(projection: Projection, size: Whole, forward: Forward = "+z") -> NDArray[numpy.float64]:
    """Returns the world direction at the centre of each texel.

    Parameters
    ----------
    projection : str
        Such as 'cube'.
    size : int
        Height of a face in texels, 1 to 65536.
    forward : str, optional
        World axis at the centre of latlong and angular images (default: '+z').

    Returns
    -------
    array of float64
        Unit vectors in the shape of Map.array: (height, width, 3), of several faces (faces, height, width, 3). Texels whose centre lies
        outside a disc have the direction of a point inside or on its rim: solid_angles() tells those that count.

    Raises
    ------
    UsageError
        A value is out of its range.

    Examples
    --------
    >>> import envmap, numpy
    >>> d = envmap.directions("latlong", 256)
    >>> sky = envmap.Map(numpy.where(d[..., 1:2] > 0, (0.2, 0.4, 1.0), (0.1, 0.1, 0.1)))   # Blue above, grey below.
    >>> round(float(sky.array[0, 0, 2]), 3)
    1.0
    """
    found = _envmap.directions(projection, size, forward)
    return found if len(found) > 1 else found[0]  # type: ignore[no-any-return]


