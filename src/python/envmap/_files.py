"""Files: read, write, encode, pack."""
import os
from typing import IO, Annotated, Any

import numpy
from numpy.typing import NDArray

from . import _envmap
from ._arguments import Count, Facts, Number, Path, Progress, Unfit, Whole, encoded_name, public
from ._errors import InputError, UsageError
from ._map import AnyMap, Claim, Map, Source, core_of, map_of
from ._words import Depth, Forward, Layout, Orientation, PixelFormat, Projection


def _opened(given: object) -> object:
    """Returns a name as the system takes it (a tuple), or the bytes of a file."""
    if isinstance(given, (str, os.PathLike)):
        return encoded_name(os.fspath(given)), os.fsdecode(given)
    if hasattr(given, "read"):
        given = given.read()
        if isinstance(given, str):
            raise Unfit("a file that is open in binary mode ('rb')")
    try:
        view = memoryview(given)  # type: ignore[arg-type]
    except TypeError:
        raise Unfit("a str, an os.PathLike, bytes or a file that is open for reading") from None
    if view.ndim != 1 or view.itemsize != 1 or not view.c_contiguous:
        raise Unfit("bytes where it is a file in memory")
    return view


File = Annotated[str | os.PathLike[str] | bytes | bytearray | memoryview | NDArray[numpy.uint8] | IO[bytes], _opened]


def _with(options: Any, **values: object) -> Any:
    """Sets the values that are not None."""
    for name, value in values.items():
        if value is not None:
            setattr(options, name, value)
    return options


@public
def read(file: File, *, projection: Projection | None = None, layout: Layout | None = None, faces: str = "",
         forward: Forward | None = None, level: Whole = 0, all_levels: bool = False, repair: bool = False,
         drop_channels: bool = False, space: str = "", working: str = "", headroom: Number | None = None, layer: str = "",
         border: Whole | None = None, border_samples: bool = False, apply_pose: bool = False, max_pixels: Count | None = None,
         max_memory: Count = 0, progress: Progress = None) -> Map:
    """Reads a map from a file, or from the bytes of a file.

    Parameters
    ----------
    file : str, os.PathLike, bytes or file object
        A name, the contents of a file as bytes, or a file that is open in binary mode. '{face}' in a name reads six files, '{half}' the
        two of a paraboloid map, and '{level}' one for each mip level.
    projection : str, optional
        Of the image: 'latlong', 'cube', 'sphere', 'paraboloid', 'angular', 'octahedral' or 'equal-area'. Default: what the file says, then
        what its shape says.
    layout : str, optional
        How the faces of a cube lie in the image: 'column', 'row', 'cross', 'vcross', '3x2' or 'files'.
    faces : str, optional
        Names and orientation of the six files of '{face}', such as 'quake' (see envmap-files(7)).
    forward : str, optional
        World axis at the centre of the image: '+z', '-z', '+x' or '-x'. Default: what the file says, then '+z'.
    level : int, optional
        The mip level to read (default: 0).
    all_levels : bool, optional
        Read all levels (default: False).
    repair : bool, optional
        Replace NaN, infinite and negative texels (default: False: they are an error).
    drop_channels : bool, optional
        Leave out alpha and other channels (default: False: they are an error).
    space : str, optional
        Colour space of the file, such as 'ACEScg'. Default: what the file says, then linear Rec.709 of floats and sRGB of integers.
    working : str, optional
        Linear colour space of the map (default: linear Rec.709).
    headroom : float, optional
        Limit of the gain map of a JPEG, in stops above white, 0 to 100. Default: all of it.
    layer : str, optional
        Read the channels LAYER.R, LAYER.G and LAYER.B of an OpenEXR file.
    border : int, optional
        Texels around an octahedral map to leave out. Default: what the file says.
    border_samples : bool, optional
        Samples lie on the border of the image, as in files with OpenEXR's envmap attribute (default: False).
    apply_pose : bool, optional
        Rotate a panorama by the pose of its camera (GPano XMP) (default: False).
    max_pixels : int, optional
        Refuse images of more pixels, all faces counted (default: 2^31).
    max_memory : int, optional
        Limit for the memory of the process in bytes. Larger maps lie in a scratch file. Default: 0, no limit.
    progress : function, optional
        Is called with the fraction done, rising to 1, in the calling thread. What it raises ends the work.

    Returns
    -------
    Map
        With the attribute `source`: format, depth, colour space, claims and notes.

    Raises
    ------
    InputError
        The file cannot be read (also a FileNotFoundError or PermissionError), or is not what it claims to be.
    UsageError
        Arguments contradict each other or the file.

    Examples
    --------
    >>> import envmap
    >>> envmap.write("sky.exr", envmap.generate("sky", size=32), depth="half")
    >>> sky = envmap.read("sky.exr")
    >>> sky.source.format, sky.source.depth, sky.source.space
    ('openexr', 'half', 'Linear Rec.709 (assumed, not specified in the file)')
    >>> envmap.read(open("sky.exr", "rb")).size
    32
    """
    options = _with(_envmap.ReadOptions(), projection=projection, layout=layout, faces=faces, forward=forward, level=level,
                    all_levels=all_levels, repair=repair, drop_channels=drop_channels, space=space, working=working, headroom=headroom,
                    layer=layer, border=border, border_samples=border_samples, apply_pose=apply_pose, max_pixels=max_pixels,
                    max_memory=max_memory)
    given: Any = file
    if isinstance(given, tuple):
        core, found = _envmap.read_file(given[0], options, progress)
        return map_of(core, _source_of(given[1], found))
    try:
        core, found = _envmap.read_bytes(given, options, progress)
    except InputError:
        if _is_name(given):
            raise UsageError("bytes are the contents of a file; these name one: os.fsdecode() makes a name of them") from None
        raise
    return map_of(core, _source_of(None, found))


def _source_of(file: str | None, found: dict[str, Any]) -> Source:
    claims = [Claim(*claim) for claim in found.pop("claims")]
    return Source(file=file, claims=claims, **found)


def _is_name(data: memoryview) -> bool:
    """Whether bytes that are no image name a file that is there."""
    name = bytes(data[:4096])
    return 0 < len(data) < 4096 and b"\0" not in name and os.path.exists(name)


@public
def write(file: Path, map: AnyMap, *, depth: Depth | None = None, layout: Layout | None = None, faces: str = "", format: str = "",
          compression: str = "", clamp: bool = False, zstd: bool = False, facts: Facts = {}, force: bool = False,
          progress: Progress = None) -> None:
    """Writes a map with its levels. The file appears whole, or not at all.

    Parameters
    ----------
    file : str or os.PathLike
        The name. Its extension is the format. '{face}' in it writes six files.
    map : Map or array
        What to write. Arrays are as in Map.
    depth : str, optional
        'uint8', 'uint16', 'rgbd', 'bc6h', 'uastc-hdr', 'rgb9e5', 'half' or 'float', as the format has it. Default: as the format stores radiance best.
    layout : str, optional
        How faces lie in the image: 'column', 'row', 'cross', 'vcross', '3x2' or 'files'.
    faces : str, optional
        Names and orientation of six files, such as 'quake'.
    format : str, optional
        An extension, such as 'exr', of a name without one.
    compression : str, optional
        Of OpenEXR and TIFF files, such as 'zip' or 'piz'.
    clamp : bool, optional
        Clamp values that the depth cannot hold (default: False: they are an error).
    zstd : bool, optional
        Compress KTX2 files (default: False).
    facts : dict of str, optional
        Further metadata, one word each.
    force : bool, optional
        Replace a file that is read-only (default: False).
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work, and no file is written.

    Raises
    ------
    OutputError
        The file cannot be written (also a FileNotFoundError where its folder is missing), or cannot hold the values.
    InputError
        The map holds NaN, infinite or negative radiance.

    Examples
    --------
    >>> import envmap
    >>> envmap.write("cube.ktx2", envmap.mipmap(envmap.generate("sky", "cube", 16)), depth="half")
    >>> len(envmap.read("cube.ktx2", all_levels=True).levels)
    5
    """
    options = _with(_envmap.WriteOptions(), depth=depth, layout=layout, faces=faces, format=format, compression=compression, clamp=clamp,
                    zstd=zstd, facts=facts, force=force)
    _envmap.write(file, core_of(map), options, progress)


@public
def encode(map: AnyMap, format: str, *, depth: Depth | None = None, layout: Layout | None = None, compression: str = "",
           clamp: bool = False, zstd: bool = False, facts: Facts = {}, progress: Progress = None) -> bytes:
    """Returns the bytes of the file that write() would write.

    Parameters
    ----------
    map : Map or array
        What to write.
    format : str
        An extension: 'exr', 'hdr', 'ktx2', 'dds', 'png' ...
    depth, layout, compression, clamp, zstd, facts, progress
        As in write().

    Returns
    -------
    bytes

    Raises
    ------
    OutputError
        The format cannot hold the values.

    Examples
    --------
    >>> import envmap
    >>> data = envmap.encode(envmap.generate("sky", size=8), "hdr")
    >>> data[:10]
    b'#?RADIANCE'
    >>> envmap.read(data)
    <envmap.Map latlong 16x8, forward +z, 1 level>
    """
    options = _with(_envmap.WriteOptions(), depth=depth, layout=layout, format=format, compression=compression, clamp=clamp, zstd=zstd,
                    facts=facts)
    return _envmap.encode(core_of(map), options, progress)  # type: ignore[no-any-return]


@public
def pack(map: AnyMap, format: PixelFormat = "rgba16f", *, orientation: Orientation = "graphics-api", clamp: bool = False,
         progress: Progress = None) -> list[NDArray[Any]]:
    """Returns the texels of all levels as a graphics API uploads them.

    Parameters
    ----------
    map : Map or array
        What to pack.
    format : str, optional
        'rgba16f' (default), 'rgba32f', 'rgb16f', 'rgb32f', 'rgb9e5' or 'bc6h'.
    orientation : str, optional
        'graphics-api' (default): cube faces are mirrored, so that OpenGL, Vulkan and Direct3D return the radiance from direction d in a
        lookup with d. 'seen-from-inside': faces as in Map.array.
    clamp : bool, optional
        Clamp values that the format cannot hold (default: False: they are an error).
    progress : function, optional
        Is called with the fraction done, rising to 1.

    Returns
    -------
    list of arrays
        One for each level, read-only and contiguous: (height, width, channels) of half or float, (height, width) of uint32 for rgb9e5,
        (rows, columns, 16) of bytes for blocks of bc6h. Cubes and paraboloids have a face index before that.

    Raises
    ------
    OutputError
        The format cannot hold the values.

    Examples
    --------
    >>> import envmap
    >>> levels = envmap.pack(envmap.mipmap(envmap.generate("sky", "cube", 8)))
    >>> [level.shape for level in levels]
    [(6, 8, 8, 4), (6, 4, 4, 4), (6, 2, 2, 4), (6, 1, 1, 4)]
    """
    return _envmap.pack(core_of(map), format, orientation, clamp, progress)  # type: ignore[no-any-return]
