#include "envmap/io/write.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <vector>

#include "envmap/error.h"
#include "envmap/io/metadata.h"
#include "envmap/io/output_file.h"
#include "envmap/io/path.h"
#include "envmap/io/pfm.h"
#include "envmap/io/srgb.h"
#include "envmap/map/page.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/parallel.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

std::string extension(const std::string& path, const WriteOptions& options) {
  std::string e = options.format;
  if (e.empty()) e = path == "-" ? "exr" : fs::path(path).extension().string();
  if (e.starts_with('.')) e.erase(0, 1);
  std::ranges::transform(e, e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

// What a format holds. Formats not named here go through OpenImageIO as 8-bit pictures.
std::vector<Depth> depths(const std::string& ext) {
  if (ext == "exr") return {Depth::half, Depth::single};
  if (ext == "hdr" || ext == "pfm") return {Depth::single};
  if (ext == "tif" || ext == "tiff") return {Depth::uint8, Depth::uint16, Depth::single};
  if (ext == "png" || ext == "ppm") return {Depth::uint8, Depth::uint16};
  return {Depth::uint8};
}

// What was asked for, or the least depth that keeps what the source had, or the most there is.
Depth choose_depth(const std::string& ext, const WriteOptions& options) {
  const std::vector<Depth> held = depths(ext);
  if (options.depth) {
    if (std::ranges::find(held, *options.depth) != held.end()) return *options.depth;
    std::string names;
    for (const Depth d : held) names += (names.empty() ? "" : " or ") + std::string(name(d));
    throw UsageError(fmt::format("--depth {}: .{} files hold {}", name(*options.depth), ext, names));
  }
  for (const Depth d : held)
    if (d >= options.source_depth) return d;
  return held.back();
}

Layout choose_layout(const std::string& path, const WriteOptions& options, Projection p) {
  if (p != Projection::cube) {
    if (options.layout) throw UsageError(fmt::format("--layout is for cube maps; this is a {} map", name(p)));
    if (has_face(path)) throw UsageError("{face} in a file name is for cube maps");
    return default_layout(p);
  }
  if (options.layout == Layout::files && !has_face(path))
    throw UsageError("--layout files: put {face} where px, nx, py, ny, pz, nz shall stand in the file name");
  if (has_face(path)) {
    if (options.layout && options.layout != Layout::files)
      throw UsageError("{face} in a file name writes six files: leave out --layout");
    return Layout::files;
  }
  return options.layout.value_or(Layout::column);
}

double largest_value(const std::string& ext, Depth depth) {
  if (is_integer(depth)) return 1;
  if (depth == Depth::half) return 65504;
  if (ext == "hdr") return 1.69e38;  // 255/256 x 2^127
  return std::numeric_limits<float>::max();
}

constexpr int band_rows = 256;

void write_with_oiio(OutputFile& file, const std::string& path, const std::string& ext, const Page& page, Depth depth,
                     float limit, const Metadata& data) {
  auto fail = [&](const std::string& why) { throw OutputError(fmt::format("{}: not written: {}", path, why)); };
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("x." + ext);
  OIIO::ImageSpec spec(page.width(), page.height(), 3, type(depth));
  spec.attribute("DateTime", "");  // OpenImageIO would write the time of day.
  spec.attribute("oiio:ColorSpace", is_integer(depth) ? "sRGB" : "Linear");
  set_metadata(spec, data);
  OIIO::Filesystem::IOProxy* proxy = &file;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (!output->open("x." + ext, spec)) fail(output->geterror());
  std::vector<Colour> band;
  for (int begin = 0; begin < page.height(); begin += band_rows) {
    const int end = std::min(begin + band_rows, page.height());
    band.resize(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(page.width()));
    page.gather(begin, end, band);
    for (Colour& c : band) c = glm::min(c, Colour(limit));
    if (is_integer(depth)) encode_srgb(band);
    if (!output->write_scanlines(begin, end, 0, OIIO::TypeDesc::FLOAT, band.data())) fail(output->geterror());
  }
  if (!output->close()) fail(output->geterror());
}

void write_page(OutputFile& file, const std::string& path, const std::string& ext, const Page& page, Depth depth, float limit,
                const Metadata& data) {
  if (ext != "pfm") return write_with_oiio(file, path, ext, page, depth, limit, data);
  write_pfm(file, page.width(), page.height(), [&](int row, std::span<Colour> out) { page.gather(row, row + 1, out); });
}

// ---- values that do not fit ------------------------------------------------------------------------------------------

struct Excess {
  std::int64_t count;
  double flux_lost;
};

Excess excess(const Level& level, double limit) {
  struct Row {
    std::int64_t count = 0;
    double lost = 0, all = 0;
  };
  Row total;
  for (const Row& row : map_rows<Row>(level.height(), [&](int j) {
         Row r;
         std::vector<double> w(static_cast<std::size_t>(level.width()));
         solid_angles(level.projection(), level.height(), j, w);
         for (int face = 0; face < level.faces(); ++face)
           for (std::size_t i = 0; i < w.size(); ++i) {
             const Direction c(level.row(face, j)[i]), over = glm::max(c - limit, Direction(0));
             r.count += over.x > 0 || over.y > 0 || over.z > 0;
             r.lost += w[i] * (over.x + over.y + over.z);
             r.all += w[i] * (c.x + c.y + c.z);
           }
         return r;
       })) {
    total.count += row.count;
    total.lost += row.lost;
    total.all += row.all;
  }
  return {total.count, total.all > 0 ? total.lost / total.all : 0};
}

bool any_above(const Level& level, double limit) {
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (const Colour& c : level.row(face, j))
        if (static_cast<double>(std::max({c.x, c.y, c.z})) > limit) return true;
  return false;
}

}  // namespace

void check_output(const std::string& path, const WriteOptions& options, Projection projection) {
  const std::string ext = extension(path, options);
  if (ext.empty()) throw UsageError(path + ": no file type; end the name in .exr, .hdr, .pfm, .tif or .png, or say --format");
  if (ext != "pfm" && !OIIO::ImageOutput::create("x." + ext)) {
    (void)OIIO::geterror();
    throw UsageError(fmt::format("{}: no format writes .{}; try .exr, .hdr, .pfm, .tif or .png", path, ext));
  }
  choose_depth(ext, options);
  choose_layout(path, options, projection);
  if (path == "-") return;
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw OutputError(fmt::format("{}: no such folder: {}", path, folder));
  if (fs::is_directory(path, error)) throw OutputError(path + ": is a folder; name a file");
}

Written write(const std::string& path, const EnvironmentMap& map, const WriteOptions& options) {
  const Level& level = map.base();
  const std::string ext = extension(path, options);
  check_output(path, options, level.projection());
  Written done{.depth = choose_depth(ext, options), .layout = choose_layout(path, options, level.projection())};

  const double limit = largest_value(ext, done.depth);
  if (any_above(level, limit)) {
    const Excess over = excess(level, limit);
    if (!options.clamp)
      throw OutputError(fmt::format("{}: {} texels over {:g} do not fit {}: choose {}or say --clamp", path, over.count, limit,
                                    name(done.depth), is_integer(done.depth) ? "a floating-point format, lower --exposure " : "--depth float, "));
    done.clamped = over.count;
    done.flux_lost = over.flux_lost;
  }

  const Metadata data{level.projection(),
                      level.projection() == Projection::cube ? std::optional(done.layout) : std::nullopt,
                      has_forward(level.projection()) ? std::optional(map.forward) : std::nullopt};
  const bool split = done.layout == Layout::files;
  // All files are written before the first appears.
  std::vector<std::unique_ptr<OutputFile>> files;
  for (int face = 0; face < (split ? level.faces() : 1); ++face) {
    const std::string one = split ? face_path(path, face) : path;
    files.push_back(std::make_unique<OutputFile>(one));
    write_page(*files.back(), one, ext, {level, grid(done.layout), split ? face : -1}, done.depth,
               static_cast<float>(limit), data);
  }
  for (const auto& file : files) file->commit();
  return done;
}

}  // namespace envmap
