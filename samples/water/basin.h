// A tiled basin with water in it, as a scene that the library draws: the water is a mesh of glass whose vertices are the
// columns of a height field, and mirrors and lenses are looked up in dynamic maps.
#pragma once

#include "envmap/scenes/scene/scene_graph.h"
#include "height_field.h"

namespace water {

using envmap::Colour;
using envmap::Direction;

/// Lengths in metres; the still surface is y = 0 and |x| <= wide, |z| <= deep are inside.
struct Basin {
  double wide = 1.6, deep = 1.0, floor = -0.7;
  double rim = 0.22;                 ///< Of the ground that it is sunk in.
  double eta = 0.75;                 ///< n outside / n inside: from air into water.
  Colour tint{0.7F, 0.16F, 0.1F};    ///< What water absorbs a metre; red goes first.
  double sunlight = 0.65;            ///< Part of the floor's light that waves gather and spread.
};

/// The basin, what stands round it, and the water.
struct Pool {
  envmap::SceneGraph scene;
  int water = 0, floor = 0;  ///< Meshes that change.
  int water_node = 0;
};

/// Of still water.
Pool make_pool(const Basin& basin, const HeightField& field);

/// Stands a scene's meshes, as they are at time 0, on the floor in the middle of the basin. Its lights, cameras and movements
/// are left out. @param height metres, of the box that holds them. @throws envmap::UsageError where it has no height.
void add_model(Pool& pool, const Basin& basin, const envmap::SceneGraph& model, double height);

/// Takes the water's mesh and the light on the floor from the field. @param sun towards it.
void set_waves(Pool& pool, const Basin& basin, const HeightField& field, const Direction& sun);

/// Where the sunlight of each column goes, refracted to the floor and gathered there: a value a column, 1 under still water.
std::vector<float> caustics(const Basin& basin, const HeightField& field, const Direction& sun);

}  // namespace water
