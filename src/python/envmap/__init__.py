"""HDR environment maps: read, convert, prefilter, measure, render, generate and write them, as numpy arrays.

    import envmap
    probe = envmap.read("probe.hdr")                                    # envmap.Map; probe.array is a view, no copy
    cube = envmap.convert(probe, "cube", size=256)                      # an array (height, width, 3) does as well
    diffuse = envmap.prefilter(cube, "diffuse", max_error=1e-4).map
    envmap.write("diffuse.exr", diffuse, depth="half")
    seen = envmap.render("room.glb", "latlong", at="Ball", environment=probe)
    picture = envmap.view("room.glb", environment=probe).array

Radiance is linear RGB, float32. The frame is right-handed, +Y up, +Z at the centre of latlong images; sizes are heights of a
face in texels. Functions never change what they are given, and let other Python threads run. progress= takes a function that
is called with the fraction done, never two calls at once, from any thread; the last value is 1. What it raises ends the work.
limit_threads() limits the threads of all calls.

Errors are envmap.Error, in one line: UsageError (a ValueError), InputError and OutputError (OSErrors), RendererError, AccuracyError.
They have code ('usage', 'input', 'output', 'renderer', 'accuracy'), file, remedy (a word of envmap/base/error.h), field (of a value out of its range),
and OSErrors also filename and errno. file, field and errno may be None: errno is set where the system refused.
"""
from ._envmap import (AccuracyError, Difference, Error, InputError, Map, OutputError, Picture, Prefiltered, RendererError, UsageError, __version__, bake,
                      brdf_table, compare, convert, encode, engines, generate, level_roughnesses, limit_threads, mipmap, pack, prefilter, read, render, sh, solid_angles, view, write)

__all__ = ["AccuracyError", "Difference", "Error", "InputError", "Map", "OutputError", "Picture", "Prefiltered", "RendererError", "UsageError", "__version__",
           "bake", "brdf_table", "compare", "convert", "encode", "engines", "generate", "level_roughnesses", "limit_threads", "mipmap", "pack", "prefilter", "read", "render", "sh", "solid_angles", "view", "write"]
