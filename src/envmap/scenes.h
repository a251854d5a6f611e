/// @file
/// Maps and pictures of scenes: libenvmap-scenes, which stands beside libenvmap.
/// CMake: find_package(envmap COMPONENTS scenes) and the target envmap::scenes. pkg-config: envmap-scenes.
#pragma once

#include "envmap/envmap.h"
#include "envmap/scenes/irradiance_grid.h"
#include "envmap/scenes/light.h"
#include "envmap/scenes/render_map.h"
#include "envmap/scenes/scene.h"
#include "envmap/scenes/view.h"
#include "envmap/scenes/write_grid.h"
