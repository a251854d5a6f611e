"""Suns and lamps of a map as lights, and the map without them."""
import dataclasses

from . import _envmap
from ._arguments import Number, Progress, Whole, public
from ._map import AnyMap, Map, core_of, map_of


@dataclasses.dataclass(frozen=True)
class DiscLight:
    """A disc of even radiance that stands for a sun or a lamp of a map.

    Attributes
    ----------
    towards : tuple of float
        Unit vector towards the light, in world axes.
    within : float
        Degrees by which the direction may be off.
    radius : float
        Angular radius in degrees.
    radius_is_bound : bool
        The map is too coarse to tell the radius: it is this large at most.
    irradiance, flux, radiance : tuple of float
        Red, green and blue: of a plane that faces the light, of the sphere, and of the disc.
    share : float
        Of the luminous flux of the map.
    """

    towards: tuple[float, float, float]
    within: float
    radius: float
    radius_is_bound: bool
    irradiance: tuple[float, float, float]
    flux: tuple[float, float, float]
    radiance: tuple[float, float, float]
    share: float


@dataclasses.dataclass(frozen=True)
class Lights:
    """What lights() found.

    Attributes
    ----------
    lights : list of DiscLight
        The strongest first.
    remainder : Map
        The map without them: its flux and that of the lights make the flux of the map.
    error : float
        Upper bound of what changes in the irradiance of unshadowed planes where lights without a size and the remainder stand for the
        map, in every direction, relative to its largest value.
    ggx_error : float
        The same of GGX reflection of a roughness.
    """

    lights: list[DiscLight]
    remainder: Map
    error: float
    ggx_error: float


@public
def lights(map: AnyMap, *, min_share: Number = 0.01, max_radius: Number = 5.0, contrast: Number = 4.0, most: Whole = 16,
           roughness: Number = 0.5, progress: Progress = None) -> Lights:
    """Finds suns and lamps, as lights that cast sharp shadows, and takes them out of the map.

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used.
    min_share : float, optional
        Least share of the map's luminous flux, 1e-6 to 1 (default: 0.01).
    max_radius : float, optional
        Largest angular radius in degrees, 0.05 to 15 (default: 5).
    contrast : float, optional
        Least luminance over that of the surroundings, from 1.5 on (default: 4).
    most : int, optional
        Largest number of lights, 1 to 256 (default: 16).
    roughness : float, optional
        Of ggx_error, 0.001 to 1 (default: 0.5).
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    Lights
        With an empty list where there are none.

    Raises
    ------
    UsageError
        A value is out of its range.
    InputError
        The map holds NaN or infinity.

    Examples
    --------
    >>> import envmap
    >>> found = envmap.lights(envmap.generate("sun", "latlong", 256, direction=(1, 2, 2), radius=1))
    >>> [round(x, 3) for x in found.lights[0].towards], round(found.lights[0].radius, 2)
    ([0.333, 0.667, 0.667], 1.0)
    """
    all_found, remainder, error, ggx_error = _envmap.lights(core_of(map), min_share, max_radius, contrast, most, roughness, progress)
    return Lights([DiscLight(*light) for light in all_found], map_of(remainder), error, ggx_error)
