#include "envmap/io/read.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <vector>

#include "envmap/error.h"
#include "envmap/io/metadata.h"
#include "envmap/io/path.h"
#include "envmap/io/recognise.h"
#include "envmap/io/srgb.h"
#include "envmap/map/page.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// What OpenImageIO complained of, as one line.
std::string first_line(std::string message) {
  message = message.substr(0, message.find('\n'));
  return message.empty() ? "no image format reads it" : message;
}

// An open image: a file, or standard input held in memory (proxy and bytes must outlive the reader).
struct Image {
  std::string name;
  std::uintmax_t size = 0;  // Of the file in bytes; 0 if unknown.
  std::vector<char> bytes;
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
  std::unique_ptr<OIIO::ImageInput> input;

  // Channel names and what a library quotes come from the file: no line breaks and no commands to the terminal.
  [[noreturn]] void fail(std::string why) const {
    std::ranges::replace_if(
        why, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
    throw InputError(name + ": " + why);
  }
};

// libpng and libjpeg print to standard error what OpenImageIO then reports, too. An error is one line: ours.
class SilentLibraries {
 public:
  explicit SilentLibraries(bool silence) : kept_(silence ? ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3) : -1) {
    if (kept_ < 0) return;
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO), ::close(nowhere);
  }
  ~SilentLibraries() {
    if (kept_ >= 0) ::dup2(kept_, STDERR_FILENO), ::close(kept_);
  }
  SilentLibraries(const SilentLibraries&) = delete;

 private:
  int kept_;
};

constexpr std::size_t head_size = 16;

// The format that the first bytes say; a Targa file has no such mark, only its name. OpenImageIO asked about a file it
// does not know tries 30 readers in turn, and some write beyond their memory even for sound files (2.4: ICO, IFF):
// none is asked but the one that fits.
std::string format_of(std::string_view head, const std::string& path) {
  if (head.starts_with("\x76\x2f\x31\x01")) return "openexr";
  if (head.starts_with("#?")) return "hdr";
  if (head.starts_with("\x89PNG")) return "png";
  if (head.starts_with("II") || head.starts_with("MM")) return "tiff";
  if (head.starts_with("\xff\xd8")) return "jpeg";
  if (head.starts_with("DDS ")) return "dds";
  if (head.size() > 1 && head[0] == 'P' && std::string_view("123456Ff").find(head[1]) != head.npos) return "pnm";
  if (head.starts_with("BM")) return "bmp";
  if (head.starts_with("SDPX") || head.starts_with("XPDS")) return "dpx";
  if (head.starts_with("8BPS")) return "psd";
  if (head.starts_with("\x01\xda")) return "sgi";
  if (head.starts_with("GIF8")) return "gif";
  if (head.find("jP  ") == 4 || head.starts_with("\xff\x4f\xff\x51")) return "jpeg2000";
  if (head.starts_with("RIFF") && head.find("WEBP") == 8) return "webp";
  return OIIO::Strutil::iends_with(path, ".tga") ? "targa" : "";
}

void open_as(Image& image, std::string_view head, const std::string& path, const OIIO::ImageSpec& config) {
  const std::string format = format_of(head, path), unread = "not an image that can be read: ";
  if (format.empty())
    image.fail(unread +
               "neither EXR, HDR, PFM, PNM, TIFF, PNG, JPEG, JPEG 2000, WebP, BMP, TGA, GIF, DPX, PSD, SGI nor DDS");
  const SilentLibraries silent(true);
  image.input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec spec;
  if (!image.input || !image.input->open(path, spec, config))
    image.fail(unread + first_line(image.input ? image.input->geterror() : OIIO::geterror()));
}

// Standard input and pipes, which cannot be read twice.
void open_stream(Image& image, std::istream& stream) {
  image.bytes.assign(std::istreambuf_iterator<char>(stream), {});
  image.size = image.bytes.size();
  if (image.bytes.empty()) image.fail("is empty");
  image.memory = std::make_unique<OIIO::Filesystem::IOMemReader>(image.bytes.data(), image.bytes.size());
  OIIO::ImageSpec config;
  void* proxy = image.memory.get();
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  open_as(image, {image.bytes.data(), std::min<std::size_t>(image.size, head_size)}, image.name, config);
}

void open_file(Image& image, const std::string& path) {
  image.name = path;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    image.fail(error && error != std::errc::no_such_file_or_directory ? error.message() : "no such file");
  if (fs::is_directory(status)) image.fail("is a folder; name a file");
  if (::access(path.c_str(), R_OK) != 0) image.fail(std::strerror(errno));
  std::ifstream stream(path, std::ios::binary);
  if (!fs::is_regular_file(status)) return open_stream(image, stream);
  image.size = fs::file_size(path, error);
  if (image.size == 0) image.fail("is empty");
  char head[head_size] = {};
  stream.read(head, sizeof head);
  open_as(image, {head, sizeof head}, path, {});
}

// First channel of the R, G, B to read, and how many: 3, or 1 for grey.
struct Channels {
  int first, count;
};

Channels choose_channels(const Image& image, const ReadOptions& options) {
  const OIIO::ImageSpec& spec = image.input->spec();
  if (spec.deep) image.fail("holds deep samples; flatten it first");
  const auto is = [&](int c, const char* wanted) { return OIIO::Strutil::iequals(spec.channel_name(c), wanted); };
  int first = -1, count = 3;
  for (int c = 0; c + 2 < spec.nchannels && first < 0; ++c)
    if (is(c, "R") && is(c + 1, "G") && is(c + 2, "B")) first = c;
  if (first < 0 && spec.nchannels >= 3 && !image.input->supports("arbitrary_metadata")) first = 0;
  if (first < 0 && spec.nchannels == 1) first = 0, count = 1;
  if (first < 0) {
    std::string names;
    for (int c = 0; c < spec.nchannels && names.size() < 40; ++c)
      names += (c ? ", " : "") + std::string(spec.channel_name(c));
    image.fail(fmt::format("no R, G and B among its {} channels ({})", spec.nchannels, names));
  }
  if (spec.nchannels > count && !options.drop_channels) {
    std::string others;
    for (int c = 0; c < spec.nchannels && others.size() < 40; ++c)
      if (c < first || c >= first + count) others += (others.empty() ? "" : ", ") + std::string(spec.channel_name(c));
    image.fail(fmt::format("has channels besides R, G and B ({}): say --drop-channels to leave them behind", others));
  }
  return {first, count};
}

void check_size(const Image& image, const OIIO::ImageSpec& spec) {
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1) image.fail("not a flat image");
  if (spec.full_width != spec.width || spec.full_height != spec.height || spec.full_x != spec.x || spec.full_y != spec.y)
    image.fail("its data window is not its display window: only part of the sphere is there");
  // A tile may reach beyond the image, but OpenImageIO takes memory for all of it, and divides by its sides.
  constexpr int roomy = 4096;
  const bool tiled = spec.tile_width != 0 || spec.tile_height != 0;
  if (tiled && (spec.tile_width < 1 || spec.tile_width > std::max(spec.width, roomy) || spec.tile_height < 1 ||
                spec.tile_height > std::max(spec.height, roomy)))
    image.fail(fmt::format("damaged: tiles of {}x{} in an image of {}x{}", spec.tile_width, spec.tile_height,
                           spec.width, spec.height));
  const double bytes = static_cast<double>(spec.width) * spec.height * sizeof(Colour);
  const double memory = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  // A header can promise anything. No compression in use makes a map 20,000 times smaller.
  if (image.size > 0 && bytes > 0x1p28 && bytes > 2e4 * static_cast<double>(image.size))
    image.fail(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", image.size, spec.width, spec.height));
  if (bytes > memory)
    image.fail(fmt::format("{}x{} needs {:.0f} GiB of memory; this machine has {:.0f}", spec.width, spec.height,
                           bytes / 0x1p30, memory / 0x1p30));
}

// Rows [begin, end) of a level as RGB. The spec is that level's.
void read_band(Image& image, const OIIO::ImageSpec& spec, int level, const Channels& channels, int begin, int end,
               std::span<Colour> out) {
  const auto colour = static_cast<OIIO::stride_t>(sizeof(Colour));
  const OIIO::stride_t line = colour * spec.width;
  const int last = channels.first + channels.count;
  const SilentLibraries silent(!spec.format.is_floating_point());
  const bool read =
      spec.tile_width > 0
          ? image.input->read_tiles(0, level, spec.x, spec.x + spec.width, spec.y + begin, spec.y + end, spec.z,
                                    spec.z + 1, channels.first, last, OIIO::TypeDesc::FLOAT, out.data(), colour, line)
          : image.input->read_scanlines(0, level, spec.y + begin, spec.y + end, spec.z, channels.first, last,
                                        OIIO::TypeDesc::FLOAT, out.data(), colour, line);
  // Some readers say true and leave a message: a cut TIFF would be black from there on.
  if (!read || image.input->has_error()) {
    const std::string why = image.input->geterror();
    image.fail("truncated or damaged: " + (why.empty() ? "it ends too early" : first_line(why)));
  }
  if (channels.count == 1)
    for (Colour& c : out) c = Colour(c.x);
}

// Size of a face in a level of a file: halved and rounded down each time. A latlong image has no place for less.
struct FaceSize {
  int width, height;
};

FaceSize face_size(const Recognised& base, int level) {
  const int height = std::max(1, base.size >> level);
  const int wide = std::max(1, (base.size * aspect(base.projection)) >> level);
  return {base.projection == Projection::latlong ? wide : height * aspect(base.projection), height};
}

// The chain goes on while there is more than one texel to a face.
int complete_levels(const Recognised& base) {
  int levels = 1;
  while (face_size(base, levels - 1).width > 1 || face_size(base, levels - 1).height > 1) ++levels;
  return levels;
}

// A level of the map, `stored` by that number in the file. Memory is taken when the first rows have been read: a header
// can promise anything.
Level read_pixels(Image& image, int stored, const Channels& channels, const Recognised& base, int number) {
  const OIIO::ImageSpec spec = image.input->spec(0, stored);
  const FaceSize face = face_size(base, number);
  const Grid places = grid(base.layout);
  if (spec.width < places.columns * face.width || spec.height < places.rows * face.height)
    image.fail(fmt::format("level {} is {}x{}, too small for faces of {}x{}", number, spec.width, spec.height,
                           face.width, face.height));
  const bool encoded = spec.format.is_floating_point() == false &&
                       !OIIO::Strutil::iequals(spec.get_string_attribute("oiio:ColorSpace"), "Linear");
  // Whole rows of tiles; enough lines that every core decompresses.
  const int unit = spec.tile_width > 0 ? spec.tile_height : 16;
  const int band_rows = (std::max(128, unit) / unit) * unit;
  std::vector<Colour> band(static_cast<std::size_t>(std::min(band_rows, spec.height)) * static_cast<std::size_t>(spec.width));
  std::optional<Level> level;
  for (int begin = 0; begin < spec.height; begin += band_rows) {
    const int end = std::min(begin + band_rows, spec.height);
    const auto rows = std::span(band).first(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(spec.width));
    read_band(image, spec, stored, channels, begin, end, rows);
    if (encoded) decode_srgb(rows);
    if (!level) level.emplace(base.projection, face.height, face.width);
    scatter(rows, spec.width, begin, end, places, *level);
  }
  return std::move(*level);
}

// From samples at the border (sample i of W at u = i/(W-1)) to cell centres, within each face.
void to_cell_centres(Level& level) {
  if (level.width() < 2 || level.height() < 2) return;
  const Level from = level;
  const double sx = (level.width() - 1.0) / level.width(), sy = (level.height() - 1.0) / level.height();
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i) {
        const double x = (i + 0.5) * sx, y = (j + 0.5) * sy;
        const int left = std::min(static_cast<int>(x), level.width() - 2),
                  top = std::min(static_cast<int>(y), level.height() - 2);
        const float fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
        const Colour *a = from.texel(face, left, top), *b = a + from.stride();
        *level.texel(face, i, j) = (1 - fy) * ((1 - fx) * a[0] + fx * a[1]) + fy * ((1 - fx) * b[0] + fx * b[1]);
      }
}

// @param shown what the message says after "texels".
void settle_flaws(const std::string& name, const ReadOptions& options, Level& level, Source& source,
                  const std::string& shown) {
  if (options.flaws == FlawPolicy::keep) return;
  const Flaws flaws = find_flaws(level);
  if (flaws.count() == 0) return;
  if (options.flaws == FlawPolicy::repair) {
    try {
      source.repaired += repair(level);
    } catch (const InputError& e) {
      throw InputError(name + ": " + e.what());
    }
    return;
  }
  std::string counts;
  const auto add = [&](std::int64_t n, const char* what) {
    if (n > 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n, what);
  };
  add(flaws.nan, "NaN");
  add(flaws.infinite, "infinite");
  add(flaws.negative, "negative");
  const std::string face = level.faces() > 1 ? fmt::format(" of face {}", flaws.first->face) : "";
  throw InputError(
      fmt::format("{}: {} of {} texels{} are no radiance ({}), the first at ({},{}){}: say --repair to replace them",
                  name, flaws.count(), static_cast<std::int64_t>(level.faces()) * level.width() * level.height(), shown,
                  counts, flaws.first->i, flaws.first->j, face));
}

void open(Image& image, const std::string& path) {
  if (path == "-") {
    image.name = "standard input";
    open_stream(image, std::cin);
  } else {
    open_file(image, path);
  }
}

// The numbers of the levels to read, of those there are.
std::vector<int> wanted_levels(const std::string& name, const ReadOptions& options, int levels) {
  if (options.level >= levels)
    throw InputError(levels == 1
                         ? fmt::format("{}: has no level {}: there is but one, 0", name, options.level)
                         : fmt::format("{}: has no level {}: its levels are 0 to {}", name, options.level, levels - 1));
  std::vector<int> wanted{options.level};
  for (int k = 1; options.all_levels && k < levels; ++k) wanted.push_back(k);
  return wanted;
}

Source read_image(const std::string& path, const ReadOptions& options) {
  Image image;
  open(image, level_path(path, 0));
  const OIIO::ImageSpec spec = image.input->spec();
  check_size(image, spec);
  const Channels channels = choose_channels(image, options);
  const Metadata recorded = metadata(spec);
  const Metadata said{options.projection, options.layout};
  const Recognised found = [&] {
    try {
      return recognise(spec.width, spec.height, said, recorded);
    } catch (const InputError& e) {
      image.fail(e.what());
    }
  }();
  Source source{.map = {},
                .layout = found.layout,
                .depth = depth_of(spec.format),
                .format = image.input->format_name(),
                .image_width = spec.width,
                .image_height = spec.height,
                .border_samples = has_border_samples(spec) && !options.ignore_envmap_attribute,
                .facts = recorded.facts};
  const int complete = complete_levels(found);
  if (has_level(path)) {
    source.levels = std::min(complete, count_level_files(path));
  } else {
    while (source.levels < complete && image.input->seek_subimage(0, source.levels)) ++source.levels;
    (void)image.input->geterror();
    source.levels = std::min(source.levels, recorded.levels.value_or(complete));
  }
  for (const int k : wanted_levels(image.name, options, source.levels)) {
    if (has_level(path) && k > 0) {
      Image one;
      open(one, level_path(path, k));
      check_size(one, one.input->spec());
      source.map.levels.push_back(read_pixels(one, 0, choose_channels(one, options), found, k));
    } else {
      source.map.levels.push_back(read_pixels(image, k, channels, found, k));
    }
  }
  if (has_forward(found.projection))
    source.map.forward =
        options.forward.value_or(recorded.forward.value_or(options.assumed_forward.value_or(Forward::plus_z)));
  return source;
}

// One level out of six files, of a cube that is `size` high at its base; 0: what the first file says.
Level read_face_files(const std::string& path, const ReadOptions& options, int number, int size, Source& source) {
  std::optional<Level> level;
  for (int face = 0; face < 6; ++face) {
    Image image;
    open_file(image, face_path(level_path(path, number), face));
    const OIIO::ImageSpec spec = image.input->spec();
    check_size(image, spec);
    if (spec.width != spec.height)
      image.fail(fmt::format("a cube face must be square, not {}x{}", spec.width, spec.height));
    if (size == 0) {
      size = spec.height;
      source.depth = depth_of(spec.format);
      source.format = image.input->format_name();
      source.image_width = source.image_height = size;
    }
    const int wanted = std::max(1, size >> number);
    if (spec.height != wanted)
      image.fail(number == 0 ? fmt::format("{}x{}, but the first face is {}x{}", spec.width, spec.height, wanted, wanted)
                             : fmt::format("{}x{}, but level {} of faces of {}x{} is {}x{}", spec.width, spec.height,
                                           number, size, size, wanted, wanted));
    if (!level) level.emplace(Projection::cube, wanted);
    // Any projection of one square face.
    const Level one =
        read_pixels(image, 0, choose_channels(image, options), {Projection::sphere, Layout::single, wanted}, 0);
    for (int j = 0; j < wanted; ++j) std::ranges::copy(one.row(0, j), level->row(face, j).begin());
  }
  return std::move(*level);
}

Source read_faces(const std::string& path, const ReadOptions& options) {
  if (options.projection && *options.projection != Projection::cube)
    throw UsageError(fmt::format("{{face}} in a file name is for cube maps, not for a {} map", name(*options.projection)));
  Source source{.map = {}, .layout = Layout::files};
  // Level 0 even where another is wanted: it tells how large that one must be.
  source.map.levels.push_back(read_face_files(path, options, 0, 0, source));
  const int size = source.map.base().height();
  source.levels =
      has_level(path) ? std::min(complete_levels({Projection::cube, Layout::files, size}), count_level_files(path)) : 1;
  for (const int k : wanted_levels(path, options, source.levels))
    if (k > 0) source.map.levels.push_back(read_face_files(path, options, k, size, source));
  if (options.level > 0) source.map.levels.erase(source.map.levels.begin());
  return source;
}

}  // namespace

Source read(const std::string& path, const ReadOptions& options) {
  const std::string name = path == "-" ? "standard input" : path;
  try {
    Source source = has_face(path) ? read_faces(path, options) : read_image(path, options);
    for (std::size_t k = 0; k < source.map.levels.size(); ++k) {
      Level& level = source.map.levels[k];
      if (source.border_samples) to_cell_centres(level);
      settle_flaws(name, options, level, source, k > 0 ? fmt::format(" of level {}", k) : "");
    }
    return source;
  } catch (const std::bad_alloc&) {
    throw InputError(name + ": not enough memory to read it");
  } catch (const std::length_error&) {  // Out of OpenImageIO's BMP reader, for one.
    throw InputError(name + ": damaged: its header promises more than any memory holds");
  }
}

}  // namespace envmap
