"""Environments with a known answer."""
from typing import Any

from . import _envmap
from ._arguments import _check_of, Number, Triple, Whole, checked, colour, public
from ._errors import UsageError
from ._map import Map, map_of
from ._words import Forward, Kind, Projection, Scattering

_WHOLE, _NUMBER, _TRIPLE, _WORD = (_check_of(kind) for kind in (Whole, Number, Triple, Scattering))
_TRUTH = _check_of(bool)
_SKY = {"zenith": colour, "horizon": colour, "ground": colour}
_PARAMETERS: dict[str, dict[str, Any]] = {
    "constant": {"radiance": colour},
    "gradient": {"bottom": colour, "top": colour},
    "checker": {"squares": _WHOLE, "even": colour, "odd": colour},
    "directions": {}, "faces": {},
    "sun": {"direction": _TRIPLE, "radius": _NUMBER, "radiance": colour, **_SKY},
    "sky": _SKY,
    "sh": {"degree": _WHOLE, "order": _WHOLE, "base": _NUMBER, "amplitude": _NUMBER},
    "atmosphere": {"direction": _TRIPLE, "turbidity": _NUMBER, "altitude": _NUMBER, "ground": colour, "radius": _NUMBER, "disc": _TRUTH,
                   "scattering": _WORD}}


@public
def generate(kind: Kind, to: Projection = "latlong", size: Whole = 64, forward: Forward = "+z", **parameters: Any) -> Map:
    """Generates an environment with a known answer.

    Parameters
    ----------
    kind : str
        A pattern and its parameters, colours as a number or three, directions as three numbers:
        - 'constant': radiance (default: 1).
        - 'gradient': bottom (0.1), top (1).
        - 'checker': squares (8), even (1), odd (0.1).
        - 'directions': (direction + 1) / 2.
        - 'faces': a colour for each axis.
        - 'sky': zenith (1), horizon (the mean of zenith and ground), ground (0.2).
        - 'sun': direction (0, 0, 1), radius in degrees (0.2666), radiance (1e5), and those of 'sky'.
        - 'sh': degree (2), order (0), base (1), amplitude (0.5).
        - 'atmosphere': a clear day, with direction of the sun, turbidity, altitude in metres, ground, radius in degrees, disc (bool) and
          scattering ('single' or 'multiple'), as in envmap-generate(1).
    to : str, optional
        Projection (default: 'latlong').
    size : int, optional
        Height of a face in texels, 1 to 65536 (default: 64).
    forward : str, optional
        World axis at the centre of latlong and angular images (default: '+z').
    **parameters
        Of the pattern.

    Returns
    -------
    Map

    Raises
    ------
    UsageError
        The kind is unknown, has no such parameter, or a value is out of its range.

    Examples
    --------
    >>> import envmap
    >>> envmap.generate("sun", "cube", 32, direction=(1, 1, 0), radius=5)
    <envmap.Map cube 32x32 x 6, forward +z, 1 level>
    """
    known = _PARAMETERS.get(kind)
    if known is None:
        raise UsageError(f"kind {kind!r} is none of {', '.join(_PARAMETERS)}")
    for name in parameters:
        if name not in known:
            raise UsageError(f"{kind} has no parameter {name}" + (f": it has {', '.join(known)}" if known else ""))
    given = {name: checked("envmap.generate", name, known[name], value) for name, value in parameters.items()}
    return map_of(_envmap.generate(kind, to, size, forward, given))
