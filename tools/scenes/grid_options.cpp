#include "scenes/grid_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/scenes/grid_of_shot.h"
#include "envmap/scenes/scene/camera.h"
#include "envmap/scenes/write_grid.h"
#include "maps/depfile.h"

namespace tools {
namespace {

using namespace envmap;

// Options of `render` that mean the same for a grid.
constexpr std::string_view shared[] = {"--size",      "--far",  "--environment",   "--ambient",    "--no-shadows",
                                       "--occlusion", "--time", "--allow-missing", "--max-pixels", "--repair"};

std::array<int, 3> cells_of(const std::string& text) {
  const auto numbers = triple_of(text);
  std::array<int, 3> cells{};
  for (int axis = 0; numbers && axis < 3; ++axis) {
    const double count = (*numbers)[axis];
    if (count >= 1 && count <= 256 && count == double(int(count))) cells[std::size_t(axis)] = int(count);
  }
  if (std::ranges::find(cells, 0) != cells.end())
    throw UsageError(fmt::format("--grid: '{}' must be NX,NY,NZ, three whole numbers from 1 to 256", text));
  return cells;
}

SceneBox box_of(const GridRequest& o, const FrameState& shot) {
  const Extent all = extent(shot.scene, shot.pose);
  const SceneBox box{o.low.value_or(all.low), o.high.value_or(all.high)};
  for (int axis = 0; axis < 3; ++axis)
    if (!(box.low[axis] < box.high[axis]))
      throw UsageError(
          fmt::format("--grid: the box has no extent along {}: give --grid-low and --grid-high", "xyz"[axis]));
  return box;
}

void put(Report& report, const IrradianceGrid& grid) {
  report.put("grid.cells", Direction(grid.cells[0], grid.cells[1], grid.cells[2]));
  report.put("grid.low", grid.box.low);
  report.put("grid.high", grid.box.high);
  report.put("grid.inside_solids", grid.invalid());
  report.put("grid.error.places", grid.error.places);
  report.put("grid.error.rms", grid.error.rms);
  report.put("grid.error.max", grid.error.max);
}

void tell(const std::string& output, const IrradianceGrid& grid) {
  note(fmt::format("{}: {}x{}x{} cells, {} inside solids", output, grid.cells[0], grid.cells[1], grid.cells[2],
                   grid.invalid()));
  if (grid.error.places > 0)
    note(fmt::format("{}: error against rays at {} random places: rms {:.2g}, max {:.2g}", output, grid.error.places,
                     grid.error.rms, grid.error.max));
  if (grid.invalid() == int(grid.light.size()))
    warn(fmt::format("{}: all cells are inside solids or behind walls: change --grid-low and --grid-high", output));
}

}  // namespace

void add_grid(Options& o, GridRequest& grid) {
  for (Option& row : o.rows)
    if (!row.is_argument() && row.excludes.empty() && std::ranges::find(shared, row.name) == std::end(shared))
      row.excludes = "--grid";
  o.group = "Irradiance grid";
  o.add("--grid", "NX,NY,NZ", &grid.cells,
        "Write irradiance at the cells of a box to a .json file, or a .ktx2 for Bevy");
  o.add("--grid-low", "X,Y,Z", Triple{&grid.low}, "Low corner of the box (default: of the scene)").needs = "--grid";
  o.add("--grid-high", "X,Y,Z", Triple{&grid.high}, "High corner of the box (default: of the scene)").needs = "--grid";
}

int write_grid(const SceneOptions& scene, const GridRequest& o, const std::string& output, Report& report) {
  GridOptions options{.cells = cells_of(o.cells), .far_metres = o.far};
  if (o.size) options.size = *o.size;
  check_grid_file(output);
  check_files({output}, {scene.path, scene.environment});
  LoadedScene loaded = load(scene);
  check_files({output}, loaded.inputs);
  open_depfile();
  const FrameState shot = loaded.shot(scene.time, scene);
  options.box = box_of(o, shot);
  const Stopwatch watch;
  const IrradianceGrid grid = grid_of(shot, options, progress_line("render"));
  write_grid(output, grid, settings().commit);
  tell(output, grid);
  tell_darkness(loaded, scene);
  report.put("input", scene.path);
  report.put("method", draw_method_names[std::size_t(DrawMethod::raycast)]);
  report.put("output", output);
  report.put("seconds", watch.seconds());
  put(report, grid);
  return 0;
}

}  // namespace tools
