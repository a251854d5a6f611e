#include "envmap/io/write.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
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

// What a format holds, least first; nothing for a format that is not written.
std::vector<Depth> depths(const std::string& ext) {
  if (ext == "exr") return {Depth::half, Depth::single};
  if (ext == "hdr" || ext == "pfm") return {Depth::single};
  if (ext == "tif" || ext == "tiff") return {Depth::uint8, Depth::uint16, Depth::single};
  if (ext == "png" || ext == "ppm") return {Depth::uint8, Depth::uint16};
  if (ext == "jpg" || ext == "jpeg" || ext == "tga" || ext == "bmp" || ext == "webp") return {Depth::uint8};
  return {};
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

// ---- values that do not fit ------------------------------------------------------------------------------------------

// What one row of one face had beyond the limit.
struct Excess {
  std::int64_t count = 0;
  double lost = 0, flux = 0;
};

// The rows, cut at the largest value the file holds; what is cut is noted per row, so that the sums do not depend on
// the order in which rows are made.
class Limited {
 public:
  Limited(const Rows& rows, double limit, bool weigh)
      : limit_(limit),
        weigh_(weigh),
        excess_(static_cast<std::size_t>(faces(rows.projection)) * static_cast<std::size_t>(rows.size)) {
    limited_ = rows;
    limited_.fill = [this, &rows](int face, int row, std::span<Colour> out) {
      rows.fill(face, row, out);
      excess_[static_cast<std::size_t>(face) * static_cast<std::size_t>(rows.size) + static_cast<std::size_t>(row)] =
          cut(row, out);
    };
  }
  Limited(const Limited&) = delete;

  [[nodiscard]] const Rows& rows() const { return limited_; }
  [[nodiscard]] Excess total() const {
    Excess sum;
    for (const Excess& e : excess_) {
      sum.count += e.count;
      sum.lost += e.lost;
      sum.flux += e.flux;
    }
    return sum;
  }

 private:
  [[nodiscard]] Excess cut(int row, std::span<Colour> out) const {
    Excess e;
    const auto limit = static_cast<float>(limit_);
    std::vector<double> w;
    if (weigh_) {
      w.resize(out.size());
      solid_angles(limited_.projection, limited_.size, row, w);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Colour c = out[i], over = glm::max(c - limit, Colour(0));
      e.count += over.x > 0 || over.y > 0 || over.z > 0;
      out[i] = glm::min(c, Colour(limit));
      if (weigh_) e.lost += w[i] * (over.x + over.y + over.z), e.flux += w[i] * (c.x + c.y + c.z);
    }
    return e;
  }

  double limit_;
  bool weigh_;
  Rows limited_;
  std::vector<Excess> excess_;
};

// ---- one file --------------------------------------------------------------------------------------------------------

// Enough rows that every core has some, few enough that they stay small beside the source.
constexpr int band_rows = 64;

using WriteBand = std::function<void(int begin, int end, std::vector<Colour>& band)>;

// Bands from the top; the next one is made while one is written.
void for_each_band(const Page& page, const Progress& progress, const WriteBand& write_band) {
  const auto make = [&](int begin, std::vector<Colour>& band) {
    const int end = std::min(begin + band_rows, page.height());
    band.resize(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(page.width()));
    page.gather(begin, end, band);
  };
  std::vector<Colour> band, next;
  make(0, band);
  for (int begin = 0; begin < page.height(); begin += band_rows) {
    const int end = std::min(begin + band_rows, page.height());
    tbb::task_group ahead;
    if (end < page.height()) ahead.run([&] { make(end, next); });
    try {
      write_band(begin, end, band);
    } catch (...) {
      ahead.wait();
      throw;
    }
    ahead.wait();
    std::swap(band, next);
    if (progress) progress(static_cast<double>(end) / page.height());
  }
}

// To the nearest value that shares an exponent among its channels (Ward 1991): OpenImageIO 2.4 truncates, which loses
// 0.4% of the light. A quarter of a step is added so that truncation gives back what was rounded.
void round_to_rgbe(std::span<Colour> pixels) {
  for (Colour& c : pixels) {
    const float most = std::max({c.x, c.y, c.z});
    if (most < 1e-32F) continue;
    int exponent = 0;
    if (std::frexp(most, &exponent) * 256 >= 255.5F) ++exponent;
    const float step = std::ldexp(1.0F, exponent - 8);
    for (int k = 0; k < 3; ++k) c[k] = (std::floor(c[k] / step + 0.5F) + 0.25F) * step;
  }
}

void write_with_oiio(OutputFile& file, const std::string& path, const std::string& ext, const Page& page, Depth depth,
                     const Metadata& data, const Progress& progress) {
  const auto fail = [&](const std::string& why) { throw OutputError(fmt::format("{}: not written: {}", path, why)); };
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("x." + ext);
  OIIO::ImageSpec spec(page.width(), page.height(), 3, type(depth));
  spec.attribute("DateTime", "");  // OpenImageIO would write the time of day.
  // Not in TIFF: it would go into an EXIF directory, and OpenImageIO 2.4 leaves the file's header pointing at that.
  if (output->format_name() != std::string("tiff"))
    spec.attribute("oiio:ColorSpace", is_integer(depth) ? "sRGB" : "Linear");
  set_metadata(spec, data);
  OIIO::Filesystem::IOProxy* proxy = &file;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (!output->open("x." + ext, spec)) fail(output->geterror());
  for_each_band(page, progress, [&](int begin, int end, std::vector<Colour>& band) {
    if (is_integer(depth)) encode_srgb(band);
    if (ext == "hdr") round_to_rgbe(band);
    if (!output->write_scanlines(begin, end, 0, OIIO::TypeDesc::FLOAT, band.data())) fail(output->geterror());
  });
  if (!output->close()) fail(output->geterror());
}

}  // namespace

void check_output(const std::string& path, const WriteOptions& options, Projection projection) {
  const std::string ext = extension(path, options);
  if (ext.empty())
    throw UsageError(path + ": no file type; end the name in .exr, .hdr, .pfm, .tif or .png, or say --format");
  if (depths(ext).empty())
    throw UsageError(fmt::format("{}: no format writes .{}; try .exr, .hdr, .pfm, .tif or .png", path, ext));
  choose_depth(ext, options);
  choose_layout(path, options, projection);
  if (path == "-") return;
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw OutputError(fmt::format("{}: no such folder: {}", path, folder));
  if (fs::is_directory(path, error)) throw OutputError(path + ": is a folder; name a file");
}

Written write(const std::string& path, const Rows& rows, const WriteOptions& options, const Progress& progress) {
  check_output(path, options, rows.projection);
  const std::string ext = extension(path, options);
  Written done{.depth = choose_depth(ext, options), .layout = choose_layout(path, options, rows.projection)};
  const double limit = largest_value(ext, done.depth);
  const Limited limited(rows, limit, options.clamp);
  const Metadata data{rows.projection, rows.projection == Projection::cube ? std::optional(done.layout) : std::nullopt,
                      has_forward(rows.projection) ? std::optional(rows.forward) : std::nullopt};

  // All files are written before the first appears.
  const int count = done.layout == Layout::files ? faces(rows.projection) : 1;
  std::vector<std::unique_ptr<OutputFile>> files;
  for (int k = 0; k < count; ++k) {
    const std::string one = count > 1 ? face_path(path, k) : path;
    files.push_back(std::make_unique<OutputFile>(one));
    const Page page{limited.rows(), grid(done.layout), count > 1 ? k : -1};
    const Progress part = !progress ? progress : [&progress, k, count](double p) { progress((k + p) / count); };
    if (ext == "pfm")
      write_pfm(*files.back(), page);
    else
      write_with_oiio(*files.back(), one, ext, page, done.depth, data, part);
  }
  const Excess over = limited.total();
  if (over.count > 0 && !options.clamp)
    throw OutputError(fmt::format("{}: {} texels over {:g} do not fit {}: choose {}or say --clamp", path, over.count,
                                  limit, name(done.depth),
                                  is_integer(done.depth) ? "a floating-point format, lower --exposure " : "--depth float "));
  done.clamped = over.count;
  done.flux_lost = over.flux > 0 ? over.lost / over.flux : 0;
  for (const auto& file : files) file->commit();
  return done;
}

}  // namespace envmap
