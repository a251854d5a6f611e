// A tiled basin of water under a sky, seen by rays.
#pragma once

#include <envmap/envmap.h>

#include <vector>

#include "height_field.h"

namespace water {

using envmap::Direction;
using envmap::Flux;

/// Lengths in metres; the still surface is y = 0 and |x| <= wide, |z| <= deep are inside.
struct Basin {
  double wide = 1.6, deep = 1.0, floor = -0.7;
  double rim = 0.12, border = 0.22;  ///< The rim's height and how far it reaches outwards.
};

/// What a ray needs. The sky is a dual-paraboloid map, its axis up: one half holds all that water reflects.
struct View {
  const Basin& basin;
  const HeightField& field;
  const envmap::EnvironmentLookup& sky;  ///< In the frame of sky_axes().
  Direction sun;                         ///< Towards it.
  Flux disc;                             ///< Radiance of the sun's disc, 2 degrees in radius, on top of the sky.
  std::vector<float> caustics;  ///< Of the floor, a value a column: sunlight that waves gather, 1 under still water.
};

/// From the map's frame to the world: the map's +Z is up.
envmap::Rotation sky_axes();

/// Where the light of each column goes: refracted to the floor and gathered there.
std::vector<float> caustics(const Basin& basin, const HeightField& field, const Direction& sun);

/// Radiance along a ray from outside of the basin. @param towards unit vector.
Flux look(const View& view, const Direction& from, const Direction& towards);

/// The part of unpolarised light that is reflected (Fresnel's equations). @param cosine of the angle of arrival.
/// @param eta n outside / n inside: 0.75 from air into water.
double fresnel(double cosine, double eta);

}  // namespace water
