"""Pictures for people."""
import struct
import zlib
from typing import Annotated, Any

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _envmap
from ._arguments import Number, Unfit, Whole, public
from ._map import AnyMap, Map
from ._operations import convert
from ._words import ToneCurve

# Rows and columns of the faces +X -X +Y -Y +Z -Z of a cube unfolded as a cross.
_CROSS = ((1, 2), (1, 0), (0, 1), (2, 1), (1, 1), (1, 3))
_LUMINANCE = numpy.array((0.2126, 0.7152, 0.0722))


def _unfolded(map: Map) -> NDArray[numpy.float32]:
    array = map.array
    if array.ndim == 3:
        return array
    n = array.shape[1]
    if len(array) == 2:
        return numpy.concatenate(list(array), 1)
    cross = numpy.zeros((3 * n, 4 * n, 3), numpy.float32)
    for face, (row, column) in zip(array, _CROSS):
        cross[row * n:(row + 1) * n, column * n:(column + 1) * n] = face
    return cross


def _exposure_of(pixels: NDArray[numpy.float32]) -> float:
    """The stops that bring the median luminance to 0.18."""
    luminance = pixels.reshape(-1, 3) @ _LUMINANCE
    lit = luminance[luminance > 0]
    return float(numpy.log2(0.18 / numpy.median(lit))) if lit.size else 0.0


def toned(pixels: NDArray[numpy.float32], exposure: float | None = None, tone: str = "neutral") -> NDArray[numpy.uint8]:
    """Returns radiance (height, width, 3) as a screen shows it: exposed, tone mapped, sRGB encoded."""
    sound = numpy.nan_to_num(pixels, nan=0, posinf=3e38, neginf=0).clip(0, None).astype(numpy.float32)
    stops = _exposure_of(sound) if exposure is None else exposure
    shown = numpy.ascontiguousarray(sound).reshape(-1, 3)
    _envmap.show(shown, tone, 2.0 ** stops)
    encoded = numpy.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)  # IEC 61966-2-1.
    return numpy.asarray(255 * encoded.clip(0, 1) + 0.5, numpy.uint8).reshape(pixels.shape)


@public
def preview(map: AnyMap, height: Whole = 256, *, exposure: Number | None = None, tone: ToneCurve = "neutral") -> NDArray[numpy.uint8]:
    """Returns a picture of a map for people: cubes as a cross, paraboloids side by side.

    In Jupyter a Map shows this picture by itself.

    Parameters
    ----------
    map : Map or array
        The map. Level 0 is shown.
    height : int, optional
        The largest height of a face in pixels, 1 to 65536 (default: 256).
    exposure : float, optional
        In stops. Default: the median luminance becomes 0.18.
    tone : str, optional
        'neutral' (default), 'reinhard' or 'clip'.

    Returns
    -------
    array of uint8
        (rows, columns, 3), sRGB encoded.

    Raises
    ------
    UsageError
        A value is out of its range.

    Examples
    --------
    >>> import envmap
    >>> picture = envmap.preview(envmap.generate("sky", "cube", 64), 32)
    >>> picture.shape, picture.dtype
    ((96, 128, 3), dtype('uint8'))
    """
    given: Any = map
    shown = convert(given, size=height) if given.size > height else given
    return toned(_unfolded(shown), exposure, tone)  # type: ignore[arg-type]


def _bytes_of_pixels(given: object) -> NDArray[numpy.uint8]:
    array = numpy.asarray(given)
    if array.dtype != numpy.uint8 or array.ndim != 3 or array.shape[2] != 3 or array.size == 0:
        raise Unfit("an array (height, width, 3) of uint8, such as preview() returns")
    return array


@public
def png(picture: Annotated[ArrayLike, _bytes_of_pixels]) -> bytes:
    """Returns a PNG file of a picture.

    Parameters
    ----------
    picture : array of uint8
        (height, width, 3), sRGB encoded, such as preview() returns.

    Returns
    -------
    bytes

    Examples
    --------
    >>> import envmap
    >>> data = envmap.png(envmap.preview(envmap.generate("sky")))
    >>> data[1:4]
    b'PNG'
    """
    pixels: NDArray[numpy.uint8] = picture  # type: ignore[assignment]
    height, width, _ = pixels.shape
    rows = numpy.zeros((height, 1 + 3 * width), numpy.uint8)  # The first byte of a row: no filter.
    rows[:, 1:] = pixels.reshape(height, -1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0") + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
            + chunk(b"IEND", b""))
