// A picture for people: maps side by side, tone mapped with one exposure, named.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "command.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/io/formats.h"
#include "envmap/io/picture.h"
#include "envmap/io/srgb.h"
#include "envmap/map/page.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"

namespace tools {
namespace {

using namespace envmap;

struct Options {
  std::vector<std::string> names;  // Inputs, then the output.
  ReadOptions read;
  std::optional<double> exposure;
  std::optional<Display> display;
  int height = 256, columns = 3;
  bool levels = false;
};

constexpr int border = 8, caption = 22;

struct Picture {
  Size size;
  std::vector<Colour> pixels;

  Picture(Size s, Colour fill)
      : size(s), pixels(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height), fill) {}
  [[nodiscard]] auto row(int x, int y) { return pixels.begin() + std::ptrdiff_t{y} * size.width + x; }
};

Picture picture(const Level& level, double scale, Display display, int height) {
  const Layout layout = level.projection() == Projection::cube ? Layout::cross : default_layout(level.projection());
  const Rows rows = rows_of(level, Forward::plus_z);
  const Page page{rows, grid(layout)};
  Picture full({page.width(), page.height()}, Colour(0));
  page.gather(0, page.height(), full.pixels);
  show(full.pixels, display, scale);
  encode_srgb(full.pixels);
  const double width = static_cast<double>(height) * page.width() / page.height();
  Picture small({std::max(1, static_cast<int>(std::lround(width))), height}, Colour(0));
  small.pixels = formats().resized(full.pixels, full.size, small.size);
  return small;
}

// All pictures in columns, each above its name.
Picture sheet_of(std::vector<Picture>& pictures, const std::vector<std::string>& captions, int most_columns) {
  const int count = static_cast<int>(pictures.size()), columns = std::min(most_columns, count);
  const int rows = (count + columns - 1) / columns, height = pictures[0].size.height;
  int cell = 0;
  for (const Picture& p : pictures) cell = std::max(cell, p.size.width);
  Picture sheet({columns * (cell + border) + border, rows * (height + caption + border) + border}, Colour(0.12F));
  for (int k = 0; k < count; ++k) {
    Picture& p = pictures[static_cast<std::size_t>(k)];
    const int x = border + k % columns * (cell + border), y = border + k / columns * (height + caption + border);
    for (int j = 0; j < height; ++j)
      std::copy_n(p.row(0, j), p.size.width, sheet.row(x + (cell - p.size.width) / 2, y + j));
    formats().draw_text(sheet.pixels, sheet.size, x + 2, y + height + 16, captions[static_cast<std::size_t>(k)], 14);
  }
  return sheet;
}

int run(Options& o, const Common& common) {
  o.read.all_levels = o.levels;
  if (o.levels && o.read.level > 0) throw UsageError("--levels shows all of them: leave out --level");
  if (o.names.size() < 2) throw UsageError("name at least one map and the picture to write");
  const std::string& output = o.names.back();
  if (output != "-" && std::filesystem::path(output).extension() != ".png")
    throw UsageError(output, "the picture must be a .png");
  const std::vector<std::string> inputs(o.names.begin(), o.names.end() - 1);
  check_files({output}, inputs, common);
  std::vector<Picture> pictures;
  std::vector<std::string> captions;
  double scale = 0;
  for (const std::string& input : inputs) {
    const Source source = read_map(input, o.read, common);
    // One exposure for all, so that they can be compared: the mean of the first becomes middle grey.
    if (scale == 0) {
      const double mean = mean_radiance(source.map.base());
      scale = o.exposure ? portable::exp2(*o.exposure) : mean > 0 ? 0.4 / mean : 1;
    }
    for (std::size_t k = 0; k < source.map.levels.size(); ++k) {
      pictures.push_back(picture(source.map.levels[k], scale, o.display.value_or(Display::reinhard), o.height));
      captions.push_back(std::filesystem::path(input).filename().string() + (o.levels ? fmt::format(" level {}", k) : ""));
    }
  }

  const auto depfile = open_depfile({output}, inputs, common);
  const Picture sheet = sheet_of(pictures, captions, o.columns);
  write_stored(output, sheet.size.width, sheet.pixels, Depth::uint8, {.commit = common.commit});
  if (depfile) depfile->commit();
  return 0;
}

}  // namespace

Command preview_command() {
  return {
      .name = "preview",
      .summary = "Draw environment maps as a picture for people: side by side, tone mapped, named",
      .description =
          "All maps share one exposure: the mean radiance of the first becomes middle grey, unless --exposure says "
          "otherwise. "
          "The tone curve is that of --display, then sRGB. Cubes are drawn as crosses.",
      .examples = {{"envmap preview probe.hdr probe.png", "one map"},
                   {"envmap preview chain.ktx2 levels.png --levels", "all mip levels of a map, each as large"},
                   {"envmap preview latlong.exr cube.exr sphere.exr sheet.png", "a contact sheet"}},
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("FILES", o->names, "Maps to draw, and last the PNG to write; '-' is standard input or output")->required()->type_name("");
        app.add_option("--exposure", o->exposure,
                       "Multiply radiance by 2^STOPS before the tone curve (default: automatic)")
            ->type_name("STOPS")
            ->check(CLI::Range(-100.0, 100.0));
        add_display(app, o->display, Display::reinhard);
        app.add_option("--height", o->height, "Height of each picture (default: 256)")->type_name("N")->check(CLI::Range(16, 4096));
        app.add_option("--columns", o->columns, "Pictures side by side (default: 3)")->type_name("N")->check(CLI::Range(1, 64));
        app.add_flag("--levels", o->levels, "Draw all mip levels of each map");
        add_read_options(app, o->read);
        add_repair(app, o->read);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools
