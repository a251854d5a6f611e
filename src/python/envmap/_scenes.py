"""Maps and pictures of scenes."""
import dataclasses
import functools
import os
import warnings
from collections.abc import Mapping
from typing import Annotated, Any

import numpy
from numpy.typing import NDArray

from . import _envmap
from ._arguments import Number, Path, Place, Progress, Triple, Unfit, Whole, file_name, place, public, shown, three_numbers
from ._errors import UsageError
from ._map import AnyMap, Map, as_map, core_of, map_of
from ._words import Context, DrawMethod, MirrorMap, Projection, Reflection, ViewMethod


def _warn(scene: "Scene", remarks: list[str]) -> None:
    for remark in remarks:
        warnings.warn(f"{scene.file or 'scene in memory'}: {remark}", stacklevel=4)  # Where the public function was called.


class Light:
    """An environment that lights scenes, worked out once: for several calls of render() or view().

    Lights of glTF scenes are in lux and candela. Radiance 1 of the map counts as 1 cd/m^2 beside them: multiply a map by its
    `source.white_luminance` where that is stated.

    Parameters
    ----------
    map : Map or array
        The environment. Level 0 is used, and copied.
    suns : bool, optional
        Suns and lamps, as lights() finds them, light surfaces as discs that cast shadows, in place of their texels. The
        background, mirrors and clear glass show the map as it is.
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Raises
    ------
    InputError
        The map holds NaN, infinite or negative values.

    Examples
    --------
    >>> import envmap
    >>> sky = envmap.Light(envmap.generate("sky", size=32))
    >>> sky
    <envmap.Light of latlong 64x32>
    """

    __slots__ = ("_core", "_map", "_suns", "__weakref__")

    @public
    def __init__(self, map: AnyMap, *, suns: bool = False, progress: Progress = None) -> None:
        self._map = Map(map)
        self._suns = suns
        self._core = _envmap.light(core_of(self._map), suns, progress)

    def __reduce__(self) -> tuple[Any, ...]:
        return functools.partial(Light, suns=self._suns), (self._map,)

    def __repr__(self) -> str:
        return f"<envmap.Light of {repr(self._map).removeprefix('<envmap.Map ').split(',')[0]}>"


def _scene(given: object) -> "Scene":
    return given if isinstance(given, Scene) else Scene(given)  # type: ignore[arg-type]


def _scene_or_name(given: object) -> object:
    return given if isinstance(given, Scene) else (file_name(given), given)[1]


def _light(given: object) -> Any:
    """Returns the compiled light of what an environment may be."""
    if given is None:
        return None
    return given._core if isinstance(given, Light) else Light(given)._core  # type: ignore[arg-type]


def _light_or_map(given: object) -> object:
    return given if isinstance(given, Light) else as_map(given)


AnyScene = Annotated["str | os.PathLike[str] | Scene", _scene_or_name]
AnyLight = Annotated["AnyMap | Light", _light_or_map]


class RenderedMap(Map):
    """A Map of a scene, and how it was drawn.

    Attributes
    ----------
    method : str
        'exact', 'distort', 'tessellate', 'resample' or 'raycast'.
    missing_solid_angle : float
        Steradians of triangles that 'distort' or 'tessellate' left out: what the map lacks at most.
    remarks : list of str
        What of the file is not drawn, and whether the map is black. They were warnings, too.
    """

    __slots__ = ("method", "missing_solid_angle", "remarks")
    method: str
    missing_solid_angle: float
    remarks: list[str]

    def __reduce__(self) -> tuple[Any, ...]:
        return _rendered, (Map(self), self.method, self.missing_solid_angle, self.remarks)


def _rendered(map: Map, method: str, missing: float, remarks: list[str]) -> RenderedMap:
    made = RenderedMap.__new__(RenderedMap)
    made._core, made._source = map._core, None
    made.method, made.missing_solid_angle, made.remarks = method, missing, remarks
    return made


def _draw(scene: "Scene", to: str, places: list[Any], size: Any, samples: Any, environment: object, ambient: object, forward: object,
          near: Any, far: Any, time: Any, method: str, shadows: bool, occlusion: Any, context: str, progress: object) -> list[RenderedMap]:
    made = scene._core.render(to, places, size, samples, _light(environment), ambient, forward, near, far, time, method, shadows, occlusion,
                              context, progress)
    return [_rendered(map_of(core), *rest) for core, *rest in made]


@public
def render(scene: AnyScene, to: Projection = "cube", *, at: Place | None = None, size: Whole = 256, samples: Whole = 1,
           environment: AnyLight | None = None, ambient: Triple | None = None, forward: Place | None = None, near: Number = 0.01,
           far: Number = 1000.0, time: Number = 0.0, method: DrawMethod = "auto", shadows: bool = True, occlusion: Whole = 64,
           context: Context = "auto", progress: Progress = None) -> RenderedMap:
    """Renders the map of a scene around a point. For several maps, keep a Scene and a Light.

    Parameters
    ----------
    scene : str, os.PathLike or Scene
        A glTF or OBJ file, or one that was read.
    to : str, optional
        Projection (default: 'cube').
    at : str or three numbers, optional
        The centre: a point, or the name of a node, which is then left out. Default: the origin.
    size : int, optional
        Height of a face in texels (default: 256).
    samples : int, optional
        Per texel (default: 1).
    environment : Map, array or Light, optional
        Light from outside of the scene.
    ambient : three numbers, optional
        Uniform radiance from all directions, not occluded by surfaces.
    forward : str or three numbers, optional
        What is at the centre of the image: '+z', '-z', '+x' or '-x' of latlong and angular maps, else a node, a point or 'camera'.
    near, far : float, optional
        Planes in metres (default: 0.01 and 1000).
    time : float, optional
        Of animations, in seconds (default: 0).
    method : str, optional
        'auto' (default), 'exact', 'distort', 'tessellate', 'resample' or 'raycast'.
    shadows : bool, optional
        Lights cast shadows (default: True).
    occlusion : int, optional
        Rays per sample for ambient occlusion (default: 64; 0: none).
    context : str, optional
        OpenGL on the GPU ('egl') or the CPU ('osmesa') (default: 'auto').
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    RenderedMap
        A Map with method, missing_solid_angle and remarks. Remarks about the scene are warnings (UserWarning), too.

    Raises
    ------
    InputError
        The scene cannot be read.
    RendererError
        There is no OpenGL; method='raycast' needs none.

    Examples
    --------
    >>> import envmap
    >>> triangle = open("triangle.obj", "w").write("v -1 -1 -3\\nv 1 -1 -3\\nv 0 1 -3\\nf 1 2 3\\n")
    >>> seen = envmap.render("triangle.obj", "latlong", size=16, ambient=(1, 1, 1), method="raycast")
    >>> bool(seen.array.max() > 0)
    True
    """
    read = _scene(scene)
    made, = _draw(read, to, [at], size, samples, environment, ambient, forward, near, far, time, method, shadows, occlusion, context, progress)
    _warn(read, made.remarks)
    return made


@dataclasses.dataclass(frozen=True, repr=False)
class Picture:
    """What view() drew, and how.

    Attributes
    ----------
    array : array of float32
        Linear radiance, (height, width, 3), rows from the top.
    mirrors : dict
        The map of each mirror that is seen, by its node's name; 'NAME (node K)' where the name is taken.
    method : str
        'maps' or 'raycast'.
    error : float or None
        Of the picture against rays, where max_error was given.
    """

    array: NDArray[numpy.float32]
    mirrors: dict[str, Map]
    method: str
    error: float | None

    def _repr_png_(self) -> bytes:
        from ._preview import png, toned
        return png(toned(self.array))

    def __repr__(self) -> str:
        height, width, _ = self.array.shape
        mirrors = f", mirrors {', '.join(self.mirrors)}" if self.mirrors else ""
        return f"<envmap.Picture {width}x{height} by {self.method}{mirrors}>"


def _mirrors(given: object) -> list[tuple[str, str | None]]:
    if not isinstance(given, Mapping):
        raise Unfit("a dict of names of nodes and 'sphere', 'paraboloid', 'cube', 'off' or None")
    for node, how in given.items():
        if not isinstance(node, str):
            raise Unfit(f"a dict whose keys are the name of a node (there is a key {shown(node)})")
        if how is not None and not isinstance(how, str):
            raise Unfit(f"a dict of 'sphere', 'paraboloid', 'cube', 'off' or None ({node!r} has {shown(how)})")
    return list(given.items())


Mirrors = Annotated[Mapping[str, str | None], _mirrors]


@public
def view(scene: AnyScene, *, camera: Place | None = None, look_at: Triple | None = None, fov: Number | None = None, width: Whole = 640,
         height: Whole = 480, samples: Whole = 4, environment: AnyLight | None = None, ambient: Triple | None = None,
         method: ViewMethod = "maps", maps: MirrorMap = "paraboloid", mirrors: Mirrors = {}, max_error: Number | None = None,
         bounces: Whole | None = None, time: Number = 0.0, reflection: Reflection = "split-sum", context: Context = "auto",
         progress: Progress = None) -> Picture:
    """Draws a picture of a scene, with mirrors and lenses drawn through maps of their own.

    Parameters
    ----------
    scene : str, os.PathLike or Scene
        A glTF or OBJ file, or one that was read.
    camera : str or three numbers, optional
        A camera of the scene, or a point. Default: the first camera.
    look_at : three numbers, optional
        The point at the centre of the picture.
    fov : float, optional
        Vertical field of view in degrees. Default: that of the camera.
    width, height : int, optional
        Of the picture in pixels (default: 640 and 480).
    samples : int, optional
        Per pixel (default: 4).
    environment, ambient
        Light from outside, as in render().
    method : str, optional
        How mirrors are drawn: 'maps' (default) or 'raycast'.
    maps : str, optional
        Projection of mirror maps: 'paraboloid' (default), 'sphere' or 'cube'.
    mirrors : dict, optional
        {node: 'sphere', 'paraboloid', 'cube', 'off' or None} for nodes whose material does not say it. None is `maps`.
    max_error : float, optional
        Use the smallest maps whose picture differs from ray casting by at most this (relative rms).
    bounces : int, optional
        Of rays between mirrors.
    time : float, optional
        Of animations, in seconds (default: 0).
    reflection : str, optional
        'split-sum' (default), or 'sampled', which is accurate on rough surfaces at grazing angles.
    context : str, optional
        OpenGL on the GPU ('egl') or the CPU ('osmesa') (default: 'auto').
    progress : function, optional
        Is called with the fraction done, rising to 1. What it raises ends the work.

    Returns
    -------
    Picture
        Remarks about the scene are warnings (UserWarning).

    Raises
    ------
    InputError
        The scene cannot be read.
    RendererError
        There is no OpenGL; method='raycast' needs none.

    Examples
    --------
    >>> import envmap
    >>> triangle = open("triangle.obj", "w").write("v -1 -1 -3\\nv 1 -1 -3\\nv 0 1 -3\\nf 1 2 3\\n")
    >>> envmap.view("triangle.obj", camera=(0, 0, 2), width=32, height=24, ambient=(1, 1, 1), method="raycast")
    <envmap.Picture 32x24 by raycast>
    """
    read = _scene(scene)
    array, cores, drawn_by, error, remarks = read._core.view(
        camera, look_at, fov, width, height, samples, _light(environment), ambient, method, maps, mirrors, max_error, bounces, time, reflection,
        context, progress)
    _warn(read, remarks)
    return Picture(array, {name: map_of(core) for name, core in cores.items()}, drawn_by, error)


def _places(given: object) -> list[Any]:
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise Unfit("a list of names and points")
    return [place(each) for each in given]


def _box(given: object) -> tuple[tuple[float, float, float], ...]:
    corners = tuple(given) if hasattr(given, "__iter__") else ()
    if len(corners) != 2:
        raise Unfit("two corners, (low, high)")
    return tuple(three_numbers(corner) for corner in corners)


def _cells(given: object) -> tuple[int, ...]:
    counts = tuple(given) if hasattr(given, "__iter__") else ()
    if len(counts) != 3 or not all(isinstance(n, (int, numpy.integer)) and not isinstance(n, bool) and 0 < n <= 256 for n in counts):
        raise Unfit("three whole numbers from 1 to 256")
    return tuple(int(n) for n in counts)


Places = Annotated["list[str | tuple[float, float, float]]", _places]
Box = Annotated["tuple[Triple, Triple]", _box]
Cells = Annotated["tuple[int, int, int]", _cells]


@dataclasses.dataclass(frozen=True, repr=False)
class IrradianceGrid:
    """Light that objects take as they move through a scene: Scene.irradiance_grid().

    Attributes
    ----------
    coefficients : array of float64
        (z, y, x, 9, 3): of each cell the nine colours of shader_sh(basis='three'). Cells inside solids have the mean of their neighbours.
    validity : array of float64
        (z, y, x): the part of all directions where a ray meets the front of a surface, or nothing. Below 0.75 a cell lies inside a solid.
    low, high : tuple of float
        Corners of the box that the cells fill.
    error_places : int
    rms, max : float
        Error of irradiance interpolated between cells, against rays, at so many random places. rms is relative to the rms of the irradiance,
        max to the irradiance of the place.
    """

    coefficients: NDArray[numpy.float64]
    validity: NDArray[numpy.float64]
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    error_places: int
    rms: float
    max: float

    def __repr__(self) -> str:
        z, y, x = self.validity.shape
        return f"<envmap.IrradianceGrid {x}x{y}x{z}, rms error {self.rms:.2g}>"


def _scene_file(given: object) -> object:
    if isinstance(given, (bytes, bytearray, memoryview)):
        return bytes(given)
    return (file_name(given), os.fspath(given))[1]  # type: ignore[call-overload]


SceneFile = Annotated["str | os.PathLike[str] | bytes | bytearray | memoryview", _scene_file]


class Scene:
    """A scene that is read once, and drawn from many places. OpenGL and its programs stay, where a method draws with it.

    Parameters
    ----------
    file : str, os.PathLike or bytes
        A .gltf, .glb or .obj file, or the bytes of one.
    folder : str or os.PathLike, optional
        Of bytes: where the files lie that they name. Default: they may name none.
    allow_missing : bool, optional
        Draw surfaces whose texture is not there without it (default: False: it is an error).

    Raises
    ------
    InputError
        The scene cannot be read.

    Examples
    --------
    >>> import envmap
    >>> scene = envmap.Scene(b"v -1 -1 -3\\nv 1 -1 -3\\nv 0 1 -3\\nf 1 2 3\\n")
    >>> sky = envmap.Light(envmap.generate("sky", size=32))
    >>> maps = scene.maps([(0, 0, 0), (0, 1, 0)], size=16, environment=sky, method="raycast")
    >>> [made.method for made in maps]
    ['raycast', 'raycast']
    """

    __slots__ = ("_core", "_given", "file", "__weakref__")

    @public
    def __init__(self, file: SceneFile, *, folder: Path | None = None, allow_missing: bool = False) -> None:
        self._given = file, folder, allow_missing
        self.file: str | None = None
        if isinstance(file, bytes):
            self._core = _envmap.read_scene_bytes(file, folder or "", allow_missing)
            return
        if folder is not None:
            raise UsageError("folder is for a scene in memory: a file names what lies in its own")
        self.file = os.fsdecode(file)
        self._core = _envmap.read_scene(file_name(file), allow_missing)

    @property
    def nodes(self) -> list[str]:
        """Names of nodes, in the order of the file."""
        return self._core.nodes()  # type: ignore[no-any-return]

    @property
    def remarks(self) -> list[str]:
        """What of the file is missing or not drawn, in sentences."""
        return self._core.remarks()  # type: ignore[no-any-return]

    def box(self, time: float = 0.0) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Returns the low and high corners of the box of all triangles, at a time in seconds."""
        return self._core.box(time)  # type: ignore[no-any-return]

    def render(self, *args: Any, **options: Any) -> RenderedMap:
        """Renders the map around a point: envmap.render() of this scene."""
        return render(self, *args, **options)

    def view(self, **options: Any) -> Picture:
        """Draws a picture: envmap.view() of this scene."""
        return view(self, **options)

    @public
    def maps(self, at: Places, to: Projection = "cube", *, size: Whole = 256, samples: Whole = 1, environment: AnyLight | None = None,
             ambient: Triple | None = None, forward: Place | None = None, near: Number = 0.01, far: Number = 1000.0, time: Number = 0.0,
             method: DrawMethod = "auto", shadows: bool = True, occlusion: Whole = 64, context: Context = "auto",
             progress: Progress = None) -> list[RenderedMap]:
        """Renders a map around each of several places.

        Parameters
        ----------
        at : list of str and points
            The centres: points, and names of nodes, which are left out of their own maps.

        The others are those of envmap.render().

        Returns
        -------
        list of RenderedMap
        """
        made = _draw(self, to, at, size, samples, environment, ambient, forward, near, far, time, method, shadows, occlusion, context, progress)
        if made:
            _warn(self, made[0].remarks)
        return made

    @public
    def irradiance_grid(self, cells: Cells = (4, 4, 4), *, box: Box | None = None, size: Whole = 16, error_places: Whole = 64,
                        environment: AnyLight | None = None, ambient: Triple | None = None, far: Number = 1000.0,
                        time: Number = 0.0, shadows: bool = True, occlusion: Whole = 64, progress: Progress = None) -> IrradianceGrid:
        """Finds the light at the cells of a box, as LightProbeGrid of three.js and IrradianceVolume of Bevy take it.

        Parameters
        ----------
        cells : three ints, optional
            Along x, y and z (default: 4, 4, 4).
        box : two corners, optional
            That the cells fill. Default: the box of the scene.
        size : int, optional
            Height of a face of the cube that is seen from each cell (default: 16).
        error_places : int, optional
            Random places where the error is measured (default: 64).

        The others are those of envmap.render().

        Returns
        -------
        IrradianceGrid
        """
        (low, high), coefficients, validity, places, rms, largest, remarks = self._core.grid(
            cells, box, size, error_places, _light(environment), ambient, far, time, shadows, occlusion, progress)
        _warn(self, remarks)
        return IrradianceGrid(coefficients, validity, low, high, places, rms, largest)

    def __reduce__(self) -> tuple[Any, ...]:
        return _read_again, self._given

    def __repr__(self) -> str:
        return f"<envmap.Scene {self.file or 'in memory'}, {len(self.nodes)} nodes>"


def _read_again(file: Any, folder: Any, allow_missing: bool) -> Scene:
    return Scene(file, folder=None if folder is None else os.fsdecode(folder), allow_missing=allow_missing)
