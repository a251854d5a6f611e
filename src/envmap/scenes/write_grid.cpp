#include "envmap/scenes/write_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "envmap/base/error.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/formats/json_array.h"
#include "envmap/io/formats/ktx.h"
#include "envmap/io/texels/texels.h"

namespace envmap {
namespace {

std::string array_of(const Direction& d) { return json_array({d.x, d.y, d.z}); }

std::string list_of(std::size_t count, const std::function<std::string(std::size_t)>& element, const char* between) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += (k == 0 ? "" : between) + element(k);
  return text;
}

std::string json_of(const IrradianceGrid& g) {
  const auto colours = [&](std::size_t cell) {
    return "[" +
           list_of(
               9, [&](std::size_t k) { return array_of(Direction(g.light[cell][k])); }, ",") +
           "]";
  };
  const Direction first = g.centre(0, 0, 0);
  const Direction step = (g.box.high - g.box.low) / Direction(g.cells[0], g.cells[1], g.cells[2]);
  return fmt::format(
      "{{\"cells\":[{},{},{}],\n\"low\":{},\"high\":{},\n\"first\":{},\"step\":{},\n"
      "\"order\":\"x fastest, then y, then z\",\n"
      "\"basis\":\"radiance: L00, L1-1, L10, L11, L2-2, L2-1, L20, L21, L22 (three, ramamoorthi)\",\n"
      "\"error\":{{\"places\":{},\"rms\":{},\"max\":{}}},\n\"validity\":[{}],\n\"coefficients\":[\n{}\n]}}\n",
      g.cells[0], g.cells[1], g.cells[2], array_of(g.box.low), array_of(g.box.high), array_of(first), array_of(step),
      g.error.places, g.error.rms, g.error.max,
      list_of(
          g.validity.size(), [&](std::size_t k) { return fmt::format("{}", g.validity[k]); }, ","),
      list_of(g.light.size(), colours, ",\n"));
}

// Where Bevy looks a cell's sides up: negative ones above the positive ones in y, axes one behind the other in z.
// Source: neg_offset and uvw_x to uvw_z of irradiance_volume.wgsl. The page of irradiance_volume.rs has the signs the
// other way round; the shader is what draws.
std::size_t texel_of(const IrradianceGrid& g, int x, int y, int z, int side) {
  const int axis = side / 2;
  const bool negative = side % 2 == 0;
  const auto t = std::size_t(y + (negative ? g.cells[1] : 0)), p = std::size_t(z + axis * g.cells[2]);
  return (p * 2 * std::size_t(g.cells[1]) + t) * std::size_t(g.cells[0]) + std::size_t(x);
}

std::vector<std::uint16_t> texels_for_bevy(const IrradianceGrid& g) {
  constexpr float largest = 65504;
  const std::vector<AmbientCube> cubes = ambient_cubes(g);
  std::vector<float> rgba(24 * cubes.size(), 1.0F);
  for (int z = 0; z < g.cells[2]; ++z)
    for (int y = 0; y < g.cells[1]; ++y)
      for (int x = 0; x < g.cells[0]; ++x)
        for (int side = 0; side < 6; ++side) {
          const Colour& c = cubes[g.index(x, y, z)][std::size_t(side)];
          if (std::max({c.x, c.y, c.z}) > largest)
            throw OutputError("holds light over 65504, the maximum of half floats: use dimmer lights");
          for (int k = 0; k < 3; ++k) rgba[4 * texel_of(g, x, y, z, side) + std::size_t(k)] = c[k];
        }
  std::vector<std::uint16_t> halves(rgba.size());
  to_half(rgba, halves);
  return halves;
}

}  // namespace

void check_grid_file(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension != "json" && extension != "ktx2")
    throw UsageError(path, "an irradiance grid is a .json, or a .ktx2 for Bevy");
  require_folder_of(path);
}

void write_grid(const std::string& path, const IrradianceGrid& grid, const CommitOptions& commit) {
  check_grid_file(path);
  if (grid.light.empty()) throw UsageError("an irradiance grid without cells cannot be written");
  const auto cells = std::size_t(grid.cells[0]) * std::size_t(grid.cells[1]) * std::size_t(grid.cells[2]);
  if (grid.light.size() != cells || grid.validity.size() != cells)
    throw UsageError(fmt::format("an irradiance grid of {} cells has light for {} and validity for {}", cells,
                                 grid.light.size(), grid.validity.size()));
  for (const auto& colours : grid.light)
    for (const auto& colour : colours)
      if (!std::isfinite(colour.x + colour.y + colour.z)) throw UsageError("an irradiance grid holds NaN or infinity");
  OutputFile file(path, commit);
  if (extension_of(path) == "json") {
    const std::string text = json_of(grid);
    file.put(text.data(), text.size());
  } else {
    const Direction size = grid.box.high - grid.box.low, centre = 0.5 * grid.box.low + 0.5 * grid.box.high;
    const std::vector<std::uint16_t> texels = texels_for_bevy(grid);
    write_ktx2_volume(file, {grid.cells[0], 2 * grid.cells[1], 3 * grid.cells[2], texels},
                      {{"envmap:grid-centre", array_of(centre)}, {"envmap:grid-scale", array_of(size)}});
  }
  file.commit();
}

}  // namespace envmap
