/// @file
/// What render() and view() check alike.
#pragma once

#include <string_view>
#include <variant>

#include "envmap/base/bounds.h"
#include "envmap/base/error.h"
#include "envmap/light/distant_lights.h"
#include "envmap/operate/check_options.h"
#include "envmap/scenes/render/drawing_method.h"

namespace envmap {

/// A point, a direction, or the name of one, where it is given. @throws UsageError where a coordinate is not finite.
template <class Place>
void check_place(std::string_view field, const Place& place) {
  if (const auto* const point = std::get_if<Direction>(&place)) check_finite(field, Flux(point->x, point->y, point->z));
}

/// @param options RenderOptions or ViewOptions. @param by_rays whether rays alone draw. @throws UsageError
template <class Options>
void check_drawing(const Options& options, bool by_rays) {
  check_enumerator("method", options.method);
  check_enumerator("context", options.context);
  check_range({"samples", 1, 1024}, options.samples);
  check_range({"time_seconds", -1e6, 1e6}, options.time_seconds);
  check_range({"occlusion", 0, max_distant_lights}, options.occlusion);
  check_range({"near_metres", 1e-9, 1e9}, options.near_metres);
  check_range({"far_metres", 1e-9, 1e12}, options.far_metres);
  if (options.ambient) check_not_negative("ambient", Flux(*options.ambient));
  if (options.near_metres >= options.far_metres) throw UsageError("near_metres must be less than far_metres");
  if (by_rays && options.context != ContextKind::automatic)
    throw UsageError("a context is for OpenGL, which the method 'raycast' does not use");
}

}  // namespace envmap
