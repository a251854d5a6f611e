"""Map: an environment map as numpy arrays."""
import dataclasses
from collections.abc import Sequence
from typing import Annotated, Any, get_args

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _envmap
from ._arguments import Unfit, checked, public
from ._errors import InputError, UsageError
from ._words import Forward, Projection

FACES = {"cube": 6, "paraboloid": 2}  # Of the others 1.


@dataclasses.dataclass(frozen=True)
class Claim:
    """What a file states of itself, and what became of it.

    Attributes
    ----------
    name, value : str
        As the format says it: 'ICC profile', 'gAMA', 'EXPOSURE'.
    outcome : str
        'honoured', 'overridden' (by an argument) or 'ignored'.
    reason : str
        Why it was ignored; else empty.
    """

    name: str
    value: str
    outcome: str
    reason: str = ""


@dataclasses.dataclass(frozen=True)
class Source:
    """What read() found in a file.

    Attributes
    ----------
    file : str or None
        The name; None of bytes.
    format, depth, layout : str
        Such as 'openexr', 'half' and 'cross'. Depths are 'uint8', 'uint16', 'rgbd', 'bc6h', 'uastc-hdr', 'rgb9e5', 'half' and 'float'.
    width, height : int
        Of the image in texels, all faces in it.
    levels : int
        That the file has. The map has those that were asked for.
    border : int
        Texels around each level of an octahedral map, which were left out.
    border_samples : bool
        Samples lie on the border of the image (OpenEXR's envmap attribute), and were resampled.
    forward_is_assumed : bool
        Neither the file nor an argument says which axis is at the centre.
    pose_applied : bool
        The map was rotated by the camera's pose (GPano XMP).
    space : str
        The colour space of the file, with what says it: 'ACEScg (chromaticities)'.
    white_luminance : float or None
        Candelas per square metre of radiance 1, where the file says it.
    repaired : int
        Texels that read(repair=True) replaced.
    facts : dict of str
        Further metadata, such as the lobe of a prefiltered map.
    claims : list of Claim
        What the file states, and what became of it.
    notes, details : list of str
        What was not read or was added, and what reading did to the values.
    """

    file: str | None
    format: str
    depth: str
    layout: str
    width: int
    height: int
    levels: int
    border: int
    border_samples: bool
    forward_is_assumed: bool
    pose_applied: bool
    space: str
    white_luminance: float | None
    repaired: int
    facts: dict[str, str]
    claims: list[Claim]
    notes: list[str]
    details: list[str]


class Map:
    """An environment map: linear RGB radiance as float32, by face and mip level.

    Parameters
    ----------
    array : Map or array of floats, optional
        (height, width, 3), of a cube (6, N, N, 3), of a paraboloid map (2, N, N, 3). Values are linear radiance, at least 0, in any
        unit. The array is copied. It may have any strides and any floating-point type. A Map is copied with all its levels.
    projection : str, optional
        'latlong', 'cube', 'sphere', 'paraboloid', 'angular', 'octahedral' or 'equal-area'. Default: 'cube' of six faces, 'latlong' of an
        image twice as wide as high. Others must be named.
    forward : str, optional
        The world axis at the centre of latlong and angular images: '+z' (default of arrays), '-z', '+x' or '-x'.
    levels : list of arrays, optional
        The levels of a mip chain instead of `array`, the largest first. Each is half the one before, rounded down.

    Raises
    ------
    UsageError
        The array is not of floats, or its shape is not that of a map.
    InputError
        The array holds NaN, infinite or negative values. repair() replaces them.

    Examples
    --------
    >>> import envmap, numpy
    >>> sky = envmap.Map(numpy.full((64, 128, 3), 0.5))
    >>> sky
    <envmap.Map latlong 128x64, forward +z, 1 level>
    >>> sky.array[10, 20] = (1, 2, 3)           # A view: this writes into the map.
    >>> float(sky.array[10, 20].sum())
    6.0
    """

    __slots__ = ("_core", "_source", "__weakref__")

    @public
    def __init__(self, array: "MapLike | None" = None, projection: Projection | None = None, forward: Forward | None = None, *,
                 levels: Sequence[ArrayLike] | None = None) -> None:
        if (array is None) == (levels is None):
            if array is None and levels is None:
                raise UsageError("a Map is made of an array or of levels=")
            raise UsageError("name an array or levels=, and not both")
        self._core: Any = None
        self._source: Source | None = None
        if isinstance(array, Map):
            if projection not in (None, array.projection):
                raise UsageError("a Map has its projection: convert() makes one in another")
            self._core, self._source = array._core.copy(forward), array._source
            return
        if levels is None:
            self._core = core_of_arrays([_floats("envmap.Map", array)], projection, forward)
            return
        if isinstance(levels, (str, bytes)) or not hasattr(levels, "__len__") or len(levels) == 0:
            raise UsageError("levels= is a list of arrays, the largest first")
        self._core = core_of_arrays([_floats("envmap.Map", level) for level in levels], projection, forward)
        self._core.check_levels()

    @property
    def array(self) -> NDArray[numpy.float32]:
        """Level 0 as a view without a copy: (height, width, 3), of several faces (faces, height, width, 3).

        Rows start at the top. Cube faces are +X -X +Y -Y +Z -Z, as seen from inside. Writing changes the map.
        """
        return self._core.levels()[0]  # type: ignore[no-any-return]

    @property
    def levels(self) -> list[NDArray[numpy.float32]]:
        """Views of all levels, the largest first."""
        return self._core.levels()  # type: ignore[no-any-return]

    @property
    def projection(self) -> Projection:
        """The projection, such as 'cube'."""
        return self._core.projection()  # type: ignore[no-any-return]

    @property
    def forward(self) -> Forward:
        """The world axis at the centre of latlong and angular images."""
        return self._core.forward()  # type: ignore[no-any-return]

    @property
    def size(self) -> int:
        """The height of a face in texels."""
        return self.array.shape[-3]

    @property
    def source(self) -> Source | None:
        """What read() found in the file; None of maps that were made."""
        return self._source

    def preview(self, height: int = 256, *, exposure: float | None = None, tone: str = "neutral") -> NDArray[numpy.uint8]:
        """Returns a picture of level 0: see envmap.preview()."""
        from ._preview import preview
        return preview(self, height, exposure=exposure, tone=tone)  # type: ignore[arg-type]

    def _repr_png_(self) -> bytes:
        from ._preview import png
        return png(self.preview())

    def __array__(self, *how: Any, **more: Any) -> NDArray[Any]:
        return self.array.__array__(*how, **more)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, ([level.copy() for level in self.levels], self.projection, self.forward, self._source)

    def __copy__(self) -> "Map":
        return Map(self)

    def __deepcopy__(self, memo: Any) -> "Map":
        return Map(self)

    def __repr__(self) -> str:
        shape, count = self.array.shape, len(self._core.levels())
        faces = f" x {shape[0]}" if len(shape) == 4 else ""
        return (f"<envmap.Map {self.projection} {shape[-2]}x{shape[-3]}{faces}, forward {self.forward}, "
                f"{count} level{'s' if count > 1 else ''}>")


# ---- maps of arrays -------------------------------------------------------------------------------------------------

WANTED = "a Map or an array of floats"


def _floats(function: str, given: object) -> NDArray[numpy.float32]:
    """Returns what numpy makes of an object, as float32. @raises UsageError where that is no radiance."""
    return checked(function, "array", floats_of, given)  # type: ignore[no-any-return]


def floats_of(given: object) -> NDArray[numpy.float32]:
    if isinstance(getattr(given, "map", None), Map):
        raise Unfit(WANTED, ": take its .map")
    if given is None or isinstance(given, (str, bytes, bytearray, dict)):
        raise Unfit(WANTED)
    try:
        array = numpy.asarray(given)
        if array.dtype == object:  # Objects are numbers, or not.
            array = numpy.asarray(array.tolist())
    except (ValueError, TypeError):
        raise Unfit(WANTED) from None
    if array.ndim == 0 or array.dtype == object:
        raise Unfit(WANTED)
    if isinstance(given, numpy.ma.MaskedArray) and given.mask.any():
        raise UsageError("a masked array has values that are none: .filled(0) or another value replaces them")
    if array.size > 0 and array.dtype.kind != "f":
        linear = ": decode it to linear floats; .astype('float32') where it is linear" if array.dtype.kind in "iu" else ": floats are"
        raise UsageError(f"an array of {array.dtype} is no radiance{linear}")
    with numpy.errstate(over="ignore"):
        return array.astype(numpy.float32, copy=False)


def _projection_of(array: NDArray[numpy.float32], projection: str | None) -> str:
    shape = array.shape
    if array.ndim in (3, 4) and shape[-1] == 4:
        raise UsageError("an array is (height, width, 3), without alpha: array[..., :3] leaves it out")
    if array.ndim not in (3, 4) or shape[-1] != 3 or array.size == 0:
        raise UsageError("an array is (height, width, 3), of a cube (6, N, N, 3), of a paraboloid map (2, N, N, 3)")
    if projection is not None:
        return projection
    if array.ndim == 4 and shape[0] == 2:
        raise UsageError("an array (2, N, N, 3) may be a paraboloid map or two images: say which by projection=")
    if array.ndim == 4:
        return "cube"
    if shape[1] != 2 * shape[0]:
        raise UsageError("an array that is not twice as wide as high may be of several projections: say which by projection=")
    return "latlong"


def _check_shape(array: NDArray[numpy.float32], projection: str, is_base: bool) -> None:
    faces = FACES.get(projection, 1)
    if not is_base and (array.ndim != (4 if faces > 1 else 3) or array.shape[-1] != 3):
        raise UsageError("all levels have the shape of the first, but for their size")
    height, width = array.shape[-3:-1]
    if is_base and projection == "latlong" and width != 2 * height:
        raise UsageError("a latlong map is twice as wide as high")
    if (array.shape[0] if array.ndim == 4 else 1) != faces or (projection != "latlong" and width != height):
        raise UsageError(f"the array's shape is not that of a {projection} map")


def _flaws(core: Any) -> InputError | None:
    """Returns the error about values that are no radiance; None where all are."""
    found = core.flaws()
    if found is None:
        return None
    level, nan, infinite, negative, (face, row, column) = found
    counts = ", ".join(f"{n} {what}" for n, what in ((nan, "NaN"), (infinite, "infinite"), (negative, "negative")) if n)
    array = core.levels()[level]
    place = f"[{row}, {column}]" if array.ndim == 3 else f"[{face}, {row}, {column}]"
    error = InputError(f"{nan + infinite + negative} of {array.size // 3} texels are no radiance ({counts}), the first at {place}"
                       + (f" of level {level}" if level else "") + ": envmap.repair() replaces them")
    error.remedy = "repair"
    return error


def core_of_arrays(arrays: list[NDArray[numpy.float32]], projection: str | None, forward: str | None, flawed: bool = False) -> Any:
    """Returns a compiled map. Flaws are an error, or are left in it."""
    projection = _projection_of(arrays[0], projection)
    for k, array in enumerate(arrays):
        if projection in get_args(Projection):  # Of others the library says which there are.
            _check_shape(array, projection, k == 0)
    core, is_doubtful = _envmap.map_of_arrays(projection, forward or "+z", arrays)
    if is_doubtful and not flawed and (error := _flaws(core)):
        raise error
    return core


def map_of(core: Any, source: Source | None = None) -> Map:
    """Returns the Map of a compiled one."""
    made = Map.__new__(Map)
    made._core, made._source = core, source
    return made


def _restored(levels: list[NDArray[numpy.float32]], projection: str, forward: str, source: Source | None) -> Map:
    # A chain that was read may round up, as its writer did.
    return map_of(core_of_arrays(levels, projection, forward, flawed=True), source)


def as_map(given: object) -> Map:
    return given if isinstance(given, Map) else map_of(core_of_arrays([floats_of(given)], None, None))


def core_of(map: Any) -> Any:
    """Returns the compiled map of what @public has made a Map."""
    return map._core


MapLike = Map | ArrayLike
AnyMap = Annotated[Map | ArrayLike, as_map]
