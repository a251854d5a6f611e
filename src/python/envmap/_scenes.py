"""Maps and pictures of scenes."""
import dataclasses
import os
import warnings
from collections.abc import Mapping
from typing import Annotated, Any

import numpy
from numpy.typing import NDArray

from . import _envmap
from ._arguments import Number, Path, Place, Progress, Triple, Unfit, Whole, public, shown
from ._map import AnyMap, Map, core_of, map_of
from ._words import Context, DrawMethod, MirrorMap, Projection, Reflection, ViewMethod


def _warn(scene: Any, remarks: list[str]) -> None:
    for remark in remarks:
        warnings.warn(f"{os.fsdecode(scene)}: {remark}", stacklevel=4)  # Where the public function was called.


@public
def render(scene: Path, to: Projection = "cube", *, at: Place | None = None, size: Whole = 256, samples: Whole = 1,
           environment: AnyMap | None = None, ambient: Triple | None = None, forward: Place | None = None, near: Number = 0.01,
           far: Number = 1000.0, time: Number = 0.0, method: DrawMethod = "auto", shadows: bool = True, occlusion: Whole = 64,
           context: Context = "auto", progress: Progress = None) -> Map:
    """Renders the map of a scene around a point.

    Parameters
    ----------
    scene : str or os.PathLike
        A glTF or OBJ file.
    to : str, optional
        Projection (default: 'cube').
    at : str or three numbers, optional
        The centre: a point, or the name of a node, which is then left out. Default: the origin.
    size : int, optional
        Height of a face in texels (default: 256).
    samples : int, optional
        Per texel (default: 1).
    environment : Map or array, optional
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
    Map
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
    >>> seen = envmap.render("triangle.obj", "latlong", size=16, ambient=(1, 1, 1), method="raycast")
    >>> bool(seen.array.max() > 0)
    True
    """
    core, remarks = _envmap.render(scene, to, at, size, samples, environment and core_of(environment), ambient, forward, near, far, time, method,
                                   shadows, occlusion, context, progress)
    _warn(scene, remarks)
    return map_of(core)


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
def view(scene: Path, *, camera: Place | None = None, look_at: Triple | None = None, fov: Number | None = None, width: Whole = 640,
         height: Whole = 480, samples: Whole = 4, environment: AnyMap | None = None, ambient: Triple | None = None,
         method: ViewMethod = "maps", maps: MirrorMap = "paraboloid", mirrors: Mirrors = {}, max_error: Number | None = None,
         bounces: Whole | None = None, time: Number = 0.0, reflection: Reflection = "split-sum", context: Context = "auto",
         progress: Progress = None) -> Picture:
    """Draws a picture of a scene, with mirrors and lenses drawn through maps of their own.

    Parameters
    ----------
    scene : str or os.PathLike
        A glTF or OBJ file.
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
    array, cores, drawn_by, error, remarks = _envmap.view(
        scene, camera, look_at, fov, width, height, samples, environment and core_of(environment), ambient, method, maps, mirrors, max_error,
        bounces, time, reflection, context, progress)
    _warn(scene, remarks)
    return Picture(array, {name: map_of(core) for name, core in cores.items()}, drawn_by, error)
