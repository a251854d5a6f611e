"""HDR environment maps: read, convert, prefilter, measure, render, generate and write them, as numpy arrays.

    import envmap
    probe = envmap.read("probe.hdr")                                    # envmap.Map; probe.array is a view, no copy
    cube = envmap.convert(probe, "cube", size=256)                      # an array (height, width, 3) does as well
    diffuse = envmap.prefilter(cube, "diffuse", max_error=1e-4).map
    envmap.write("diffuse.exr", diffuse, depth="half")
    seen = envmap.render("room.glb", "latlong", at="Ball", environment=probe)

Radiance is linear RGB, float32. The frame is right-handed, +Y up, +Z at the centre of latlong images; sizes are heights of a
face in texels. Functions never change what they are given, and let other Python threads run. progress= takes a function that
is called with the part done, 0 to 1, from any thread; what it raises ends the work. Errors are envmap.Error, in one line:
UsageError (a ValueError), InputError and OutputError (OSErrors), RendererError.
"""
from ._envmap import (Difference, Error, InputError, Map, OutputError, Prefiltered, RendererError, UsageError, compare, convert,
                      generate, mipmap, prefilter, read, render, sh, solid_angles, write)

__all__ = ["Difference", "Error", "InputError", "Map", "OutputError", "Prefiltered", "RendererError", "UsageError", "compare",
           "convert", "generate", "mipmap", "prefilter", "read", "render", "sh", "solid_angles", "write"]
