/// @file
/// The whole library, as it is installed. envmap(3) shows it at work.
///
/// Pixels are linear RGB radiance, float32. The frame is right-handed with +Y up; +Z lies at the centre of latlong and
/// angular images. Sizes are heights of a face in texels, solid angles steradians, angles radians unless a name says
/// degrees. Functions never change what they
/// read. Errors are exceptions, subclasses of envmap::Error.
#pragma once

#include "envmap/base/error.h"
#include "envmap/base/run.h"
#include "envmap/base/version.h"
#include "envmap/engine/bake.h"
#include "envmap/engine/level_roughness.h"
#include "envmap/engine/suns.h"
#include "envmap/io/claims/colour.h"
#include "envmap/io/images/picture.h"
#include "envmap/io/read.h"
#include "envmap/io/texels/pack.h"
#include "envmap/io/texels/pixel_buffer.h"
#include "envmap/io/write.h"
#include "envmap/light/distant_lights.h"
#include "envmap/light/light_error.h"
#include "envmap/light/lights.h"
#include "envmap/light/restore_sun.h"
#include "envmap/map/environment_map.h"
#include "envmap/map/rows.h"
#include "envmap/operate/atmosphere.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/importance_sampling.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/lookup.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/photograph.h"
#include "envmap/prefilter/brdf_table.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/harmonics_window.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/shader_sh.h"
#include "envmap/projection/matching_size.h"
