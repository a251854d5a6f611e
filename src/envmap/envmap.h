/// @file
/// The whole library, as it is installed. envmap(3) shows it at work.
///
/// Pixels are linear RGB radiance, float32. The frame is right-handed with +Y up; +Z lies at the centre of latlong and
/// angular images. Sizes are heights of a face in texels, solid angles steradians, angles radians unless a name says
/// degrees. Functions never change what they
/// read. Errors are exceptions, subclasses of envmap::Error.
#pragma once

// What most programs need.
#include "envmap/base/error.h"              // Error: ErrorCode, Remedy
#include "envmap/base/run.h"                // Run: progress, stop token, threads
#include "envmap/base/version.h"            // ENVMAP_VERSION
#include "envmap/io/read.h"                 // read(): Source
#include "envmap/io/read_lobe.h"            // read_lobe(): tables, measured materials
#include "envmap/io/texels/pack.h"          // pack(): PackedMap, for a graphics API
#include "envmap/io/texels/pixel_buffer.h"  // map_of(), copy_to(): images in memory
#include "envmap/io/write.h"                // write(), encode()
#include "envmap/map/environment_map.h"     // EnvironmentMap: Level, Frame
#include "envmap/operate/convert.h"         // convert()
#include "envmap/operate/levels.h"          // add_levels()
#include "envmap/operate/lookup.h"          // EnvironmentLookup
#include "envmap/prefilter/prefilter.h"     // Prefilterer: Lobe

// Engines and shaders.
#include "envmap/engine/bake.h"             // bake(): an engine's folder
#include "envmap/engine/level_roughness.h"  // level_roughnesses() of an engine's chain
#include "envmap/engine/suns.h"             // suns in an engine's words
#include "envmap/prefilter/brdf_table.h"    // brdf_table(), sheen_table(): the split sum
#include "envmap/prefilter/shader_sh.h"     // shader_sh(): nine colours

// Light: lamps and suns, sampling, irradiance, spherical harmonics.
#include "envmap/light/distant_lights.h"         // distant_lights(): median cut
#include "envmap/light/light_error.h"            // light_error(): of a light without a size
#include "envmap/light/lights.h"                 // find_lights(), take_out()
#include "envmap/light/restore_sun.h"            // restore_sun(), clipped_sun()
#include "envmap/operate/grade.h"                // irradiance(), radiance_within(), white_balance()
#include "envmap/operate/importance_sampling.h"  // ImportanceSampler
#include "envmap/prefilter/harmonics.h"          // project(), evaluate()
#include "envmap/prefilter/harmonics_window.h"   // weakest_window()

// Made maps, measured maps, pictures.
#include "envmap/io/claims/colour.h"          // colour spaces of files
#include "envmap/io/images/picture.h"         // show(), write_picture()
#include "envmap/map/rows.h"                  // Rows: maps that are made row by row
#include "envmap/operate/atmosphere.h"        // generate(Atmosphere)
#include "envmap/operate/generate.h"          // generate(Sky), (Sun), ...
#include "envmap/operate/measure.h"           // compare(), measure(), find_flaws()
#include "envmap/operate/photograph.h"        // photograph(): perspective and fisheye
#include "envmap/projection/matching_size.h"  // matching_size()
