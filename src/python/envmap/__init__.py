"""HDR environment maps: read, convert, prefilter, measure, render, generate and write them, as numpy arrays.

    import envmap
    probe = envmap.read("probe.hdr")                                    # envmap.Map; probe.array is a view, no copy
    cube = envmap.convert(probe, "cube", size=256)                      # an array (height, width, 3) does as well
    diffuse = envmap.prefilter(cube, "diffuse", max_error=1e-4).map
    envmap.write("diffuse.exr", diffuse, depth="half")
    light = envmap.lookup(cube, [(0, 1, 0), (0, 0, 1)])                 # radiance from directions
    seen = envmap.render("room.glb", "latlong", at="Ball", environment=probe)
    maps = envmap.Scene("room.glb").maps([(0, 1, 0), (2, 1, 0)], environment=envmap.Light(probe))   # read and prepared once

Radiance is linear RGB, float32. The frame is right-handed, +Y up, +Z at the centre of latlong images. Sizes are heights of a face in
texels, angles are degrees. Functions never change what they are given. Other Python threads run meanwhile.

progress= takes a function of the fraction done. It is called in the thread of the call, and the last value is 1. What it raises ends the
work. Ctrl-C ends every call within half a second. limit_threads() limits the threads of all calls.

Errors are envmap.Error, in one line: UsageError (a ValueError), ArgumentError (also a TypeError), InputError and OutputError (OSErrors),
RendererError and AccuracyError. They have code, file, remedy and field. OSErrors have filename and errno, and missing files are
FileNotFoundErrors.

Functions, maps, results and errors can be pickled, for process pools and caches.
"""
import os as _os

from . import _envmap
from ._arguments import Path, Place, Progress, Triple
from ._engines import bake, engines, limit_threads
from ._errors import AccuracyError, ArgumentError, Error, InputError, OutputError, RendererError, UsageError
from ._files import encode, pack, read, write
from ._generate import generate
from ._light import Lookup, Prefiltered, brdf_table, irradiance, level_roughnesses, lookup, prefilter, sh, shader_sh
from ._lights import DiscLight, Lights, lights
from ._map import Claim, Map, MapLike, Source
from ._operations import Difference, Info, compare, convert, directions, info, mipmap, photograph, repair, solid_angles
from ._preview import png, preview
from ._scenes import IrradianceGrid, Light, Picture, RenderedMap, Scene, render, view
from ._words import (Context, Depth, DrawMethod, Filter, Forward, Kind, Layout, Lens, Lobe, Method, Mirror, MirrorMap, Orientation, PixelFormat,
                     Projection, Quality, Reflection, Scattering, ShBasis, ToneCurve, ViewMethod, Weights, Window)

__version__: str = _envmap.__version__
_os.register_at_fork(before=_envmap.before_fork)

__all__ = ["AccuracyError", "ArgumentError", "Claim", "Difference", "DiscLight", "Error", "Info", "InputError", "IrradianceGrid", "Light",
           "Lights", "Lookup", "Map", "OutputError", "Picture", "Prefiltered", "RenderedMap", "RendererError", "Scene", "Source",
           "UsageError", "__version__", "bake", "brdf_table", "compare", "convert", "directions", "encode", "engines", "generate", "info",
           "irradiance", "level_roughnesses", "lights", "limit_threads", "lookup", "mipmap", "pack", "photograph", "png", "prefilter",
           "preview", "read", "render", "repair", "sh", "shader_sh", "solid_angles", "view", "write",
           # Types of arguments, for annotations.
           "Context", "Depth", "DrawMethod", "Filter", "Forward", "Kind", "Layout", "Lens", "Lobe", "MapLike", "Method", "Mirror", "MirrorMap",
           "Orientation", "Path", "PixelFormat", "Place", "Progress", "Projection", "Quality", "Reflection", "Scattering", "ShBasis",
           "ToneCurve", "Triple", "ViewMethod", "Weights", "Window"]

# Where pickles, help() and tracebacks look for them.
for _name in __all__:
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = "envmap"
