/// @file
/// The frames that normal maps are meant in.
#pragma once

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// Tangents from texture coordinates, as MikkTSpace has them, which glTF (2.0, 3.7.2.1) asks for where a file has none:
/// at each vertex the mean of those of the triangles that meet in its place with its normal and coordinates and are not
/// mirrored against each other, weighed by their angles there. (MikkTSpace keeps triangles apart, too, that share
/// nothing but that corner.) Vertices of triangles that are mirrored against each other come to stand twice.
/// Source: Mikkelsen 2008, "Simulation of wrinkled surfaces revisited".
void add_tangents(Mesh& mesh);

}  // namespace envmap
