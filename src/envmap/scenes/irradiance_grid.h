/// @file
/// Light that objects take as they move through a scene: nine colours at each cell of a box.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/prefilter/shader_sh.h"
#include "envmap/scenes/light.h"
#include "envmap/scenes/scene.h"

namespace ENVMAP_EXPORT envmap {

struct GridOptions {
  std::array<int, 3> cells{4, 4, 4};             ///< Along x, y and z, 1 to 256 each.
  std::optional<SceneBox> box = {};              ///< Cells fill it. Absent: Scene::box().
  int size = 16;                                 ///< Height of a face of the cube that is seen from a cell, 4 to 256.
  int error_places = 64;                         ///< Random places where the error is measured, 0 to 4096.
  double far_metres = 1000;                      ///< Nothing further is seen.
  double time_seconds = 0;                       ///< Of the scene's movements, -1e6 to 1e6.
  std::optional<Colour> ambient = {};            ///< Radiance from all round, on surfaces.
  bool shadows = true;
  int occlusion = 64;  ///< Lights that stand for the environment where its shadows are found, 0 to 256.
};

/// Of irradiance that is interpolated between cells, against rays and a sum over all their directions.
struct GridError {
  int places = 0;  ///< That lie outside of solids; at each, surfaces that face eight ways.
  double rms = 0;  ///< Of the difference, over that of the irradiance.
  double max = 0;  ///< The largest difference, over the irradiance there or 0.001 of the mean.
};

struct IrradianceGrid {
  std::array<int, 3> cells{0, 0, 0};
  SceneBox box;
  /// Of each cell's middle, by ShBasis::three without a window: shaders clamp what falls below 0. x runs fastest, then
  /// y, then z. Cells inside solids have the mean of their neighbours that are not.
  std::vector<ShaderSh> light;
  /// The part of all directions where the first surface shows its front, or nothing is: below least_validity inside
  /// solids, and behind walls that are seen from one side only.
  std::vector<double> validity;
  GridError error;
  std::vector<std::string> remarks;  ///< What of the file is not drawn, in sentences.

  static constexpr double least_validity = 0.75;

  /// The middle of a cell.
  [[nodiscard]] Direction centre(int x, int y, int z) const;
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(cells[1]) + std::size_t(y)) * std::size_t(cells[0]) + std::size_t(x);
  }
  /// How many cells lie inside solids.
  [[nodiscard]] int invalid() const;

  /// Irradiance of a surface, linear between the middles of cells; beyond those of the outermost as at them.
  /// @param normal of any length.
  [[nodiscard]] Flux irradiance(const Direction& at, const Direction& normal) const;
};

/// What `envmap render --at` shows at the middle of each cell, by rays, as irradiance. @param light null: black.
/// @throws UsageError where an option is out of its range, or the box is empty.
IrradianceGrid irradiance_grid(const Scene& scene, const GridOptions& options = {}, const Light* light = nullptr,
                               const Run& run = {});

/// Six colours of each cell, irradiance / pi of surfaces that face -x, +x, -y, +y, -z and +z: ambient cubes (Mitchell
/// 2006, "Shading in Valve's Source Engine").
using AmbientCube = std::array<Colour, 6>;
std::vector<AmbientCube> ambient_cubes(const IrradianceGrid& grid);

}  // namespace envmap
