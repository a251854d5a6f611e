// A picture for people: maps side by side, tone mapped with one exposure, named.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "command.h"
#include "envmap/error.h"
#include "envmap/io/picture.h"
#include "envmap/io/srgb.h"
#include "envmap/map/page.h"
#include "envmap/operate/measure.h"

namespace tools {
namespace {

using namespace envmap;

struct Options {
  std::vector<std::string> names;  // Inputs, then the output.
  ReadOptions read;
  std::optional<double> exposure;
  int height = 256, columns = 3;
  bool levels = false;
};

constexpr int border = 8, caption = 22;

// Reinhard et al. 2002, equation 3, per channel; sRGB encoded.
void tone_map(std::vector<Colour>& pixels, double scale) {
  for (Colour& c : pixels) {
    const Direction x = scale * Direction(c);
    c = Colour(x / (1.0 + x));
  }
  encode_srgb(pixels);
}

OIIO::ImageBuf picture(const Level& level, double scale, int height) {
  const Layout layout = level.projection() == Projection::cube ? Layout::cross : default_layout(level.projection());
  const Rows rows = rows_of(level, Forward::plus_z);
  const Page page{rows, grid(layout)};
  std::vector<Colour> pixels(static_cast<std::size_t>(page.width()) * static_cast<std::size_t>(page.height()));
  page.gather(0, page.height(), pixels);
  tone_map(pixels, scale);
  const OIIO::ImageSpec spec(page.width(), page.height(), 3, OIIO::TypeDesc::FLOAT);
  const OIIO::ImageBuf full(spec, pixels.data());
  const int width = std::max(1, static_cast<int>(std::lround(static_cast<double>(height) * page.width() / page.height())));
  return OIIO::ImageBufAlgo::resize(full, "", 0, OIIO::ROI(0, width, 0, height, 0, 1, 0, 3));
}

int run(Options& o, const Common& common) {
  o.read.all_levels = o.levels;
  if (o.levels && o.read.level > 0) throw UsageError("--levels shows all of them: leave out --level");
  if (o.names.size() < 2) throw UsageError("name at least one map and the picture to write");
  const std::string& output = o.names.back();
  if (std::filesystem::path(output).extension() != ".png") throw UsageError(output + ": the picture must be a .png");
  const std::vector<std::string> inputs(o.names.begin(), o.names.end() - 1);
  std::vector<OIIO::ImageBuf> pictures;
  std::vector<std::string> captions;
  double scale = 0;
  for (const std::string& input : inputs) {
    const Source source = read_map(input, o.read, common);
    // One exposure for all, so that they can be compared: the mean of the first becomes middle grey.
    if (scale == 0) {
      const double mean = mean_radiance(source.map.base());
      scale = o.exposure ? std::exp2(*o.exposure) : mean > 0 ? 0.4 / mean : 1;
    }
    for (std::size_t k = 0; k < source.map.levels.size(); ++k) {
      pictures.push_back(picture(source.map.levels[k], scale, o.height));
      captions.push_back(std::filesystem::path(input).filename().string() + (o.levels ? fmt::format(" level {}", k) : ""));
    }
  }

  const int columns = std::min(o.columns, static_cast<int>(pictures.size()));
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  int cell = 0;
  for (const auto& p : pictures) cell = std::max(cell, p.spec().width);
  OIIO::ImageBuf sheet(OIIO::ImageSpec(columns * (cell + border) + border,
                                       rows * (o.height + caption + border) + border, 3, OIIO::TypeDesc::FLOAT));
  OIIO::ImageBufAlgo::fill(sheet, {0.12F, 0.12F, 0.12F});
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const int x = border + static_cast<int>(k) % columns * (cell + border);
    const int y = border + static_cast<int>(k) / columns * (o.height + caption + border);
    OIIO::ImageBufAlgo::paste(sheet, x + (cell - pictures[k].spec().width) / 2, y, 0, 0, pictures[k]);
    // Without any font on the machine the sheet has no names.
    (void)OIIO::ImageBufAlgo::render_text(sheet, x + 2, y + o.height + 16, captions[k], 14, "DejaVuSans", {0.8F, 0.8F, 0.8F});
    (void)sheet.geterror();
  }
  const auto depfile = open_depfile(output, inputs, common);
  const OIIO::ImageSpec& spec = sheet.spec();
  write_encoded(output, spec.width,
                {static_cast<const Colour*>(sheet.localpixels()), static_cast<std::size_t>(spec.image_pixels())});
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
          "Tone curve x / (1 + x) (Reinhard et al. 2002), sRGB. Cubes are drawn as crosses.",
      .examples = {{"envmap preview probe.hdr probe.png", "one map"},
                   {"envmap preview chain.ktx2 levels.png --levels", "all mip levels of a map, each as large"},
                   {"envmap preview latlong.exr cube.exr sphere.exr sheet.png", "a contact sheet"}},
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("FILES", o->names, "Maps to draw, and last the PNG to write")->required()->type_name("");
        app.add_option("--exposure", o->exposure,
                       "Multiply radiance by 2^STOPS before the tone curve (default: automatic)")
            ->type_name("STOPS")
            ->check(CLI::Range(-100.0, 100.0));
        app.add_option("--height", o->height, "Height of each picture (default: 256)")->type_name("N")->check(CLI::Range(16, 4096));
        app.add_option("--columns", o->columns, "Pictures side by side (default: 3)")->type_name("N")->check(CLI::Range(1, 64));
        app.add_flag("--levels", o->levels, "Draw all mip levels of each map");
        add_read_options(app, o->read);
        add_repair(app, o->read);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools
