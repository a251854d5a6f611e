// EXR files, by OpenEXR itself: what is checked before OpenEXR takes memory, reading, and writing.
#include "envmap/io/formats/openexr.h"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#if __has_include(<ImfContextInit.h>)
#include <ImfContextInit.h>
#endif

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/words.h"
#include "envmap/io/files/input_file.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/images/check_tiles.h"
#include "envmap/io/images/data_window.h"
#include "envmap/io/texels/texels.h"
#include "envmap/maths/portable.h"

namespace envmap {

// Our files as OpenEXR reads and writes them.

namespace {

class ExrInput final : public Imf::IStream {
 public:
  explicit ExrInput(const InputFile& file) : IStream("exr"), file_(file) {}
  bool read(char* to, int size) override {
    const auto wanted = std::size_t(size);
    if (file_.pread(to, wanted, at_) != wanted) throw Iex::InputExc("it ends too early");
    at_ += wanted;
    return at_ < file_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t place) override { at_ = place; }

 private:
  const InputFile& file_;
  std::uint64_t at_ = 0;
};

/// All parts of a file. OpenEXR 3.3 and newer would also print the errors that they throw.
struct ExrParts final : Imf::MultiPartInputFile {
#if __has_include(<ImfContextInit.h>)
  explicit ExrParts(ExrInput& stream)
      : MultiPartInputFile("exr", Imf::ContextInitializer()
                                      .silentHeaderParse(true)
                                      .strictHeaderValidation(false)
                                      .setErrorHandler([](exr_const_context_t, exr_result_t, const char*){})
                                      .setInputStream(&stream)) {}
#else
  explicit ExrParts(ExrInput& stream) : MultiPartInputFile(stream) {}
#endif
};

class ExrOutput final : public Imf::OStream {
 public:
  explicit ExrOutput(OutputFile& file) : OStream("exr"), file_(file) {}
  void write(const char* from, int size) override {
    const auto wanted = std::size_t(size);
    if (file_.write(from, wanted) != wanted) throw Iex::IoExc("the disk is full or the file cannot be written");
  }
  std::uint64_t tellp() override { return std::uint64_t(file_.tell()); }
  void seekp(std::uint64_t place) override { file_.seek(std::int64_t(place)); }

 private:
  OutputFile& file_;
};

/// OpenEXR's helpers beside the caller, who works, too, where there are none. A forked process has none of its parent's
/// and would wait for them: they end before, and the next file starts them anew.
inline void use_our_threads() {
  static const int registered = pthread_atfork([] { Imf::setGlobalThreadCount(0); }, nullptr, nullptr);
  (void)registered;
  const int threads = thread_limit();
  Imf::setGlobalThreadCount(threads > 1 ? threads : 0);
}

/// Without what OpenEXR puts before it: `Error reading pixel data from image file "exr". `.
inline std::string plain(const std::string& message) {
  const auto quote = message.find("\"exr\". ");
  return quote == std::string::npos ? message : message.substr(quote + 7);
}

}  // namespace

// These checks of a header come before OpenEXR takes memory.

namespace {

// The bytes of a header, one after the other ("OpenEXR file layout": little-endian, texts end in 0).
class Cursor {
 public:
  explicit Cursor(const InputFile& file) : file_(file) {}

  template <class T>
  T get() {
    T value;
    read(&value, sizeof value);
    return value;
  }
  std::string text() {
    constexpr std::size_t most = 256;
    std::string found;
    for (char c = get<char>(); c != '\0'; c = get<char>()) {
      if (found.size() == most) throw InputError("damaged: a name in its header has no end");
      found += c;
    }
    return found;
  }
  void skip_to(std::uint64_t place) { at_ = place; }
  [[nodiscard]] std::uint64_t at() const { return at_; }
  [[nodiscard]] std::uint64_t left() const { return file_.size() - std::min(at_, file_.size()); }

 private:
  void read(void* to, std::size_t size) {
    if (left() < size) throw InputError("it ends too early");
    if (at_ < from_ || at_ + size > from_ + held_) {
      from_ = at_;
      held_ = file_.pread(buffer_.data(), buffer_.size(), at_);
    }
    std::memcpy(to, buffer_.data() + (at_ - from_), size);
    at_ += size;
  }

  const InputFile& file_;
  std::uint64_t at_ = 0, from_ = 0, held_ = 0;
  std::array<char, 4096> buffer_ = {};
};

// The attributes that decide how many chunks a part has.
struct Part {
  std::array<std::int32_t, 4> window{};  // Of data: least x and y, largest.
  unsigned char compression = 3;         // Zip, where nothing is said.
  bool tiled = false;
  std::uint32_t tile_width = 0, tile_height = 0;
  unsigned char mode = 0;

  [[nodiscard]] double width() const { return 1.0 + window[2] - window[0]; }
  [[nodiscard]] double height() const { return 1.0 + window[3] - window[1]; }
};

// OpenEXR reads as many bytes as a type has, whatever the attribute says of its size,
// and what is next begins after them.
constexpr std::pair<std::string_view, int> sizes_of_types[] = {{"box2f", 16},
                                                               {"box2i", 16},
                                                               {"chromaticities", 32},
                                                               {"compression", 1},
                                                               {"deepImageState", 1},
                                                               {"double", 8},
                                                               {"envmap", 1},
                                                               {"float", 4},
                                                               {"int", 4},
                                                               {"keycode", 28},
                                                               {"lineOrder", 1},
                                                               {"m33d", 72},
                                                               {"m33f", 36},
                                                               {"m44d", 128},
                                                               {"m44f", 64},
                                                               {"rational", 8},
                                                               {"tiledesc", 9},
                                                               {"timecode", 8},
                                                               {"v2d", 16},
                                                               {"v2f", 8},
                                                               {"v2i", 8},
                                                               {"v3d", 24},
                                                               {"v3f", 12},
                                                               {"v3i", 12}};

bool size_fits(Cursor& in, std::string_view type, std::uint64_t size) {
  const auto* const known = std::ranges::find(sizes_of_types, type, &std::pair<std::string_view, int>::first);
  if (known != std::end(sizes_of_types)) return size == std::uint64_t(known->second);
  if (type != "chlist") return true;
  // Names, each with its type, flags and sampling; an empty one is the last.
  const std::uint64_t begin = in.at();
  while (!in.text().empty()) in.skip_to(in.at() + 16);
  return in.at() == begin + size;
}

// Attributes as far as they are wanted. @return whether there was a header: an empty one ends a list of parts.
bool read_header(Cursor& in, Part& part) {
  bool any = false;
  for (std::string name = in.text(); !name.empty(); name = in.text(), any = true) {
    const std::string type = in.text();
    const auto size = in.get<std::int32_t>();
    // OpenEXR takes the memory before it looks.
    if (size < 0 || std::uint64_t(size) > in.left())
      throw InputError(fmt::format("damaged: an attribute of {} bytes in a file of fewer", size));
    const std::uint64_t begin = in.at(), end = begin + std::uint64_t(size);
    if (!size_fits(in, type, end - begin))
      throw InputError(fmt::format("damaged: an attribute of type {} has {} bytes", type, size));
    in.skip_to(begin);
    if (name == "dataWindow" && size == 16) part.window = in.get<std::array<std::int32_t, 4>>();
    if (name == "compression" && size == 1) part.compression = in.get<unsigned char>();
    if (name == "tiles" && size == 9) {
      part.tile_width = in.get<std::uint32_t>();
      part.tile_height = in.get<std::uint32_t>();
      part.mode = in.get<unsigned char>();
    }
    if (name == "type" && size < 16) {
      std::string kind;
      for (int k = 0; k < size; ++k) kind += in.get<char>();
      part.tiled = kind == "tiledimage" || kind == "deeptile";
    }
    in.skip_to(end);
  }
  return any;
}

// Lines that are compressed together: by the number of the compression, none rle zips zip piz pxr24 b44 b44a dwaa dwab.
double lines_of_chunk(unsigned char compression) {
  constexpr int lines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return compression < std::size(lines) ? lines[compression] : 1;
}

// How many times smaller than its floats a chunk can be.
double most_smaller(unsigned char compression) {
  const bool dwa = compression == 8 || compression == 9;
  return dwa ? 2e5 : 2e4;
}

// Tiles along a side of a level; each is half the one before, rounded down or up.
double tiles_along(double side, int level, bool up, double tile) {
  const double halved = side / portable::exp2(level);
  return std::ceil(std::max(1.0, up ? std::ceil(halved) : std::floor(halved)) / tile);
}

double chunks_of(const Part& p) {
  if (!p.tiled) return std::ceil(p.height() / lines_of_chunk(p.compression));
  if (p.tile_width < 1 || p.tile_height < 1) throw InputError("damaged: tiles without a size");
  const int mode = p.mode & 15;
  const bool up = p.mode >> 4 != 0;
  const auto levels = [&](double side) {
    return 1 + int(up ? std::ceil(portable::log2(side)) : std::floor(portable::log2(side)));
  };
  const auto across = [&](int level) { return tiles_along(p.width(), level, up, p.tile_width); };
  const auto down = [&](int level) { return tiles_along(p.height(), level, up, p.tile_height); };
  double chunks = across(0) * down(0);
  if (mode == 1)
    for (int k = 1; k < levels(std::max(p.width(), p.height())); ++k) chunks += across(k) * down(k);
  if (mode == 2) {
    double columns = 0, rows = 0;
    for (int k = 0; k < levels(p.width()); ++k) columns += across(k);
    for (int k = 0; k < levels(p.height()); ++k) rows += down(k);
    chunks = columns * rows;
  }
  return chunks;
}

}  // namespace

void check_openexr(const InputFile& file) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::uint32_t flag_tiled = 0x200, flag_parts = 0x1000;
  Cursor in(file);
  in.get<std::uint32_t>();  // The mark.
  const auto version = in.get<std::uint32_t>();
  double chunks = 0;
  for (bool more = true; more;) {
    Part part{.tiled = (version & flag_tiled) != 0};
    const bool any = read_header(in, part);
    more = any && (version & flag_parts) != 0;
    if (!any) break;
    if (part.width() < 1 || part.height() < 1) throw InputError("damaged: its data window is empty");
    // No compression in use makes a map 20,000 times smaller; DWA keeps one number of 64, in zlib's 1000 times fewer
    // bytes. OpenEXR takes memory for all lines of a chunk, if there are fewer in the image, too.
    const double bytes = part.width() * std::max(part.height(), lines_of_chunk(part.compression)) * 12;
    if (bytes > 0x1p28 && bytes > most_smaller(part.compression) * double(file.size()))
      throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {:.0f}x{:.0f}", file.size(),
                                   part.width(), part.height()));
    chunks += chunks_of(part);
    // The file begins with the places of all of them, 8 bytes each.
    if (8 * chunks > double(in.left()))
      throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {:.0f} chunks", file.size(), chunks));
  }
}

// Reading.

namespace {

// An opened file and one part of it, of which one reader is set once pixels have been asked for.
struct ExrIn {
  ExrInput stream;
  ExrParts parts;
  int part = 0;
  std::vector<bool> inverted = {};  // For each chosen channel, whether it was asked for as 1/NAME.
  ExrInput again;                   // For the reader of luminance and chroma.
  std::optional<Imf::InputPart> lines = {};
  std::optional<Imf::TiledInputPart> tiles = {};
  std::optional<Imf::RgbaInputFile> luminance = {};

  explicit ExrIn(const InputFile& file) : stream(file), parts(stream), again(file) {}
  [[nodiscard]] const Imf::Header& header() const { return parts.header(part); }
};

// An image in lines may have a description of tiles all the same.
bool in_tiles(const Imf::Header& header) {
  return header.hasTileDescription() && header.hasType() && Imf::isTiled(header.type());
}

// R, G and B first, each beside the next.
std::vector<std::string> channel_names(const Imf::ChannelList& list) {
  std::vector<std::string> names;
  for (const char* first : {"R", "r", "G", "g", "B", "b"})
    if (list.findChannel(first)) names.emplace_back(first);
  for (auto c = list.begin(); c != list.end(); ++c)
    if (std::ranges::find(names, c.name()) == names.end()) names.emplace_back(c.name());
  return names;
}

Attributes attributes_of(const Imf::Header& header) {
  Attributes texts;
  for (auto a = header.begin(); a != header.end(); ++a)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
      texts.emplace(std::string_view(a.name()) == "comments" ? description
                    : std::string_view(a.name()) == "owner"  ? copyright
                                                             : a.name(),
                    text->value());
  const auto aces = header.find("acesImageContainerFlag");  // SMPTE ST 2065-4.
  const auto* const flag = aces != header.end() ? dynamic_cast<const Imf::IntAttribute*>(&aces.attribute()) : nullptr;
  if (flag != nullptr && flag->value() == 1) texts["acesImageContainerFlag"] = "1";
  // The attribute alone decides the text: a converted file may carry the word without the attribute.
  texts.erase("textureformat");
  if (Imf::hasEnvmap(header))
    texts["textureformat"] = Imf::envmap(header) == Imf::ENVMAP_CUBE ? "CubeFace Environment" : "LatLong Environment";
  return texts;
}

Provenance colours_of(const Imf::Header& header) {
  Provenance p;
  if (Imf::hasWhiteLuminance(header) && std::isfinite(Imf::whiteLuminance(header)))
    p.white_luminance = Imf::whiteLuminance(header);
  if (p.white_luminance && *p.white_luminance <= 0)
    throw InputError(fmt::format("damaged: a whiteLuminance of {}, which no light has", *p.white_luminance));
  if (!Imf::hasChromaticities(header)) return p;
  const Imf::Chromaticities& c = Imf::chromaticities(header);
  p.chromaticities = {c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
  return p;
}

// @param wanted channels that are to come first.
ImageFacts facts_of(const Imf::Header& header, const std::vector<std::string>& wanted) {
  const Imath::Box2i data = header.dataWindow();
  ImageFacts f{.width = int(std::min<std::int64_t>(1L + data.max.x - data.min.x, INT_MAX)),
               .height = int(std::min<std::int64_t>(1L + data.max.y - data.min.y, INT_MAX)),
               .flat = !header.hasType() || !Imf::isDeepData(header.type()),
               .depth = Depth::half,
               .channels = wanted,
               .attributes = attributes_of(header),
               .provenance = colours_of(header),
               .chosen = int(wanted.size())};
  for (const std::string& name : channel_names(header.channels()))
    if (std::ranges::find(wanted, name) == wanted.end()) f.channels.push_back(name);
  if (in_tiles(header)) {
    f.tile_width = int(std::min<unsigned>(header.tileDescription().xSize, INT_MAX));
    f.tile_height = int(std::min<unsigned>(header.tileDescription().ySize, INT_MAX));
  }
  const std::size_t colours = wanted.empty() ? std::min<std::size_t>(f.channels.size(), 3) : wanted.size();
  for (std::size_t k = 0; k < colours; ++k)
    if (header.channels()[f.channels[k]].type != Imf::HALF) f.depth = Depth::single;
  return f;
}

// The same of a smaller level.
std::optional<ImageFacts> level_facts(const ExrIn& file, ImageFacts f, int level) {
  const Imf::Header& header = file.header();
  if (level == 0) return f;
  if (!in_tiles(header) || header.tileDescription().mode != Imf::MIPMAP_LEVELS) return std::nullopt;
  const bool up = header.tileDescription().roundingMode == Imf::ROUND_UP;
  const int longer = std::max(f.width, f.height);
  if (level > 30 || (up ? (longer - 1) >> (level - 1) : longer >> level) == 0) return std::nullopt;
  const auto side = [&](int n) { return std::max(1, int((n + (up ? (1L << level) - 1 : 0)) >> level)); };
  f.width = side(f.width), f.height = side(f.height);
  return f;
}

void check_channel(const std::string& name, const Imf::Channel& channel) {
  if (channel.type == Imf::UINT) throw InputError(fmt::format("channel {} holds whole numbers, not radiance", name));
  if (channel.xSampling != 1 || channel.ySampling != 1)
    throw InputError(fmt::format("channel {} is not sampled in every pixel", name));
}

// Where the channels of an image go: (0, 0) of the window is at its place in the file.
Imf::FrameBuffer frame(const ExrIn& file, const ImageFacts& f, int begin, int first, int count, float* out) {
  const Imath::Box2i window = file.header().dataWindow();
  const auto pixel = std::ptrdiff_t(sizeof(float)) * count, line = pixel * f.width;
  char* origin = reinterpret_cast<char*>(out) - pixel * window.min.x - line * (std::ptrdiff_t{window.min.y} + begin);
  Imf::FrameBuffer buffer;
  for (int c = 0; c < count; ++c) {
    const std::string& name = f.channels[std::size_t(first + c)];
    check_channel(name, file.header().channels()[name]);
    buffer.insert(name, Imf::Slice(Imf::FLOAT, origin + std::ptrdiff_t(sizeof(float)) * c, std::size_t(pixel),
                                   std::size_t(line)));
  }
  return buffer;
}

void read_tiles(ExrIn& file, const Imf::FrameBuffer& buffer, const ImageFacts& f, int level, int begin, int end) {
  if (!file.tiles) file.tiles.emplace(file.parts, file.part);
  file.tiles->setFrameBuffer(buffer);
  file.tiles->readTiles(0, (f.width - 1) / f.tile_width, begin / f.tile_height, (end - 1) / f.tile_height, level,
                        level);
}

void read_lines(ExrIn& file, const Imf::FrameBuffer& buffer, int begin, int end) {
  if (!file.lines) file.lines.emplace(file.parts, file.part);
  const int top = file.header().dataWindow().min.y;
  file.lines->setFrameBuffer(buffer);
  file.lines->readPixels(top + begin, top + end - 1);
}

// OpenEXR fills one place for each channel, the last: others of its name get the same.
void repeat_channels(std::span<const std::string> names, std::span<float> texels) {
  for (std::size_t c = 0; c < names.size(); ++c) {
    std::size_t filled = c;
    for (std::size_t k = c + 1; k < names.size(); ++k)
      if (names[k] == names[c]) filled = k;
    if (filled == c) continue;
    for (std::size_t k = 0; k + names.size() <= texels.size(); k += names.size()) texels[k + c] = texels[k + filled];
  }
}

void read_rows(ExrIn& file, const ImageFacts& facts, int level, int begin, int end, int first, int count,
               std::span<float> out) {
  const ImageFacts f = *level_facts(file, facts, level);
  const Imf::FrameBuffer buffer = frame(file, f, begin, first, count, out.data());
  try {
    if (f.tile_width > 0)
      read_tiles(file, buffer, f, level, begin, end);
    else
      read_lines(file, buffer, begin, end);
  } catch (const Iex::BaseExc& e) {
    throw InputError(plain(e.what()));
  }
  const std::span<const std::string> names(f.channels.begin() + first, std::size_t(count));
  const std::span<float> texels = out.first(std::size_t(end - begin) * std::size_t(f.width) * names.size());
  repeat_channels(names, texels);
  for (std::size_t c = 0; c < names.size(); ++c)
    if (const std::size_t channel = std::size_t(first) + c; channel < file.inverted.size() && file.inverted[channel])
      for (std::size_t k = c; k < texels.size(); k += names.size()) texels[k] = 1 / texels[k];
}

// ---- what to read of it ---------------------------------------------------------------------------------------------

void choose_part(ExrIn& file, const std::string& wanted, ImageFacts& facts) {
  const int count = file.parts.parts();
  std::vector<std::string> names;
  for (int k = 0; k < count; ++k)
    names.push_back(file.parts.header(k).hasName() ? file.parts.header(k).name() : std::to_string(k));
  if (wanted.empty()) {
    if (count > 1) facts.notes.push_back(fmt::format("of its {} parts ({}) the first is read", count, some_of(names)));
    return;
  }
  for (int k = 0; k < count; ++k)
    if (names[std::size_t(k)] == wanted || std::to_string(k) == wanted) {
      file.part = k;
      return;
    }
  throw InputError(fmt::format("has no part '{}': there {} {}", wanted, count == 1 ? "is" : "are", some_of(names)));
}

// Layers with R, G and B, as channels NAME.R or the like. NAME itself may hold dots.
std::vector<std::string> layers(const Imf::ChannelList& list) {
  std::vector<std::string> found;
  for (auto c = list.begin(); c != list.end(); ++c)
    if (const std::string name = c.name(); name.ends_with(".R")) {
      const std::string layer = name.substr(0, name.size() - 2);
      if (list.findChannel(layer + ".G") && list.findChannel(layer + ".B")) found.push_back(layer);
    }
  return found;
}

// The channels that are R, G and B, or grey; none: the names say it.
std::vector<std::string> choose_channels(ExrIn& file, const ImageChoice& choice, ImageFacts& facts) {
  const Imf::ChannelList& list = file.header().channels();
  const auto of = [](const std::string& layer) { return std::vector{layer + ".R", layer + ".G", layer + ".B"}; };
  const std::vector<std::string> there = layers(list);
  if (!choice.layer.empty()) {
    if (std::ranges::find(there, choice.layer) != there.end()) return of(choice.layer);
    throw InputError(fmt::format("has no layer '{}' with R, G and B: {}", choice.layer,
                                 there.empty() ? "it has no layers" : "its layers are " + some_of(there)));
  }
  if (!choice.channels.empty()) {
    std::vector<std::string> wanted = split(choice.channels, ',');
    if (wanted.size() != 3 && wanted.size() != 1)
      throw UsageError("channels are three names with commas between them, or one");
    for (std::string& name : wanted) {
      file.inverted.push_back(name.starts_with("1/") && !list.findChannel(name));
      if (file.inverted.back()) name.erase(0, 2);
      if (!list.findChannel(name))
        throw InputError(fmt::format("has no channel '{}': its channels are {}", name, some_of(channel_names(list))));
    }
    return wanted;
  }
  const auto has = [&](const char* upper, const char* lower) {
    return list.findChannel(upper) || list.findChannel(lower);
  };
  if ((has("R", "r") && has("G", "g") && has("B", "b")) || there.empty()) return {};
  if (there.size() > 1)
    throw InputError(fmt::format("holds no plain R, G and B but layers ({})", some_of(there)), Remedy::choose_layer);
  facts.notes.push_back(fmt::format("the layer '{}' is read", there[0]));
  return of(there[0]);
}

// Chroma in every second pixel of every second line; in tiles OpenEXR knows no such thing.
bool is_luminance_and_chroma(const Imf::Header& header) {
  const auto is_chroma = [&](const char* name) {
    const Imf::Channel* const channel = header.channels().findChannel(name);
    return channel != nullptr && (in_tiles(header) || (channel->xSampling == 2 && channel->ySampling == 2));
  };
  return header.channels().findChannel("Y") && is_chroma("RY") && is_chroma("BY");
}

void read_luminance(ExrIn& file, const ImageFacts& f, int begin, int end, int first, int count, std::span<float> out) {
  try {
    if (!file.luminance) file.luminance.emplace(file.again);
    const Imath::Box2i window = file.header().dataWindow();
    std::vector<Imf::Rgba> rows(std::size_t(end - begin) * std::size_t(f.width));
    const std::ptrdiff_t line = f.width;
    file.luminance->setFrameBuffer(rows.data() - window.min.x - line * (std::ptrdiff_t{window.min.y} + begin), 1,
                                   std::size_t(line));
    file.luminance->readPixels(window.min.y + begin, window.min.y + end - 1);
    float* to = out.data();
    for (const Imf::Rgba& p : rows)
      for (int c = first; c < first + count; ++c) *to++ = c == 0 ? p.r : c == 1 ? p.g : c == 2 ? p.b : p.a;
  } catch (const Iex::BaseExc& e) {
    throw InputError(plain(e.what()));
  }
}

}  // namespace

ImageReader open_openexr(const InputFile& bytes, const ImageChoice& choice) {
  use_our_threads();
  check_openexr(bytes);
  std::shared_ptr<ExrIn> file;
  try {
    file = std::make_shared<ExrIn>(bytes);
  } catch (const Iex::BaseExc& e) {
    throw InputError("not an image that can be read: " + plain(e.what()));
  }
  ImageFacts facts;
  choose_part(*file, choice.part, facts);
  const Imf::Header& header = file->header();
  const std::vector<std::string> wanted = choose_channels(*file, choice, facts);
  std::vector<std::string> notes = std::move(facts.notes);
  facts = facts_of(header, wanted);
  facts.notes = std::move(notes);
  check_tiles(facts);
  const bool luminance = wanted.empty() && file->part == 0 && is_luminance_and_chroma(header);
  if (luminance) {
    facts.channels = {"R", "G", "B"};
    if (header.channels().findChannel("A")) facts.channels.emplace_back("A");
    facts.depth = Depth::half;
    facts.details.emplace_back("luminance and chroma became RGB");
  }
  for (const std::string& name : wanted.empty() ? std::vector<std::string>{"R", "G", "B", "r", "g", "b"} : wanted)
    if (const Imf::Channel* const channel = header.channels().findChannel(name)) check_channel(name, *channel);
  ImageReader reader{.format = "openexr", .facts = facts, .read = {}};
  // Imf::RgbaInputFile reads the largest level alone.
  if (!luminance) reader.level = [file, facts](int level) { return level_facts(*file, facts, level); };
  reader.read = [file, facts, luminance](int level, int begin, int end, int first, int count, std::span<float> out) {
    if (luminance)
      read_luminance(*file, facts, begin, end, first, count, out);
    else
      read_rows(*file, facts, level, begin, end, first, count, out);
  };
  const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
  const auto part = facts.attributes.find("envmap:part");  // shard.h
  if (part != facts.attributes.end())
    reader.facts.notes.push_back(
        fmt::format("is part {} of a map, and the rest of it is black: merge the parts", part->second));
  if (data == display) return reader;
  if (part == facts.attributes.end())
    reader.facts.notes.push_back(
        fmt::format("its data window ({},{} to {},{}) is not its display window ({},{} to {},{}): {}", data.min.x,
                    data.min.y, data.max.x, data.max.y, display.min.x, display.min.y, display.max.x, display.max.y,
                    choice.crop ? "the data window is read as the whole image" : "what is missing is black"));
  if (choice.crop) return reader;
  const auto length = [](std::int64_t from, std::int64_t to) {
    return int(std::min<std::int64_t>(1 + to - from, INT_MAX));
  };
  return in_window(std::move(reader),
                   {std::int64_t{data.min.x} - display.min.x, std::int64_t{data.min.y} - display.min.y,
                    length(display.min.x, display.max.x), length(display.min.y, display.max.y)});
}

// Writing.

namespace {

constexpr const char* channels[] = {"R", "G", "B"};
constexpr const char* depth_channel = "Z";

// A file being written; `lines` or `tiles` is set.
struct ExrOut {
  ExrOutput stream;
  Imf::PixelType type;
  std::optional<Imf::OutputFile> lines = {};
  std::optional<Imf::TiledOutputFile> tiles = {};
  std::vector<std::uint16_t> halves = {};
  std::vector<float> distances = {};

  ExrOut(OutputFile& out, Imf::PixelType t) : stream(out), type(t) {}
};

struct NamedCompression {
  std::string_view name;
  Imf::Compression compression;
};
constexpr NamedCompression compressions[] = {{"none", Imf::NO_COMPRESSION},   {"rle", Imf::RLE_COMPRESSION},
                                             {"zips", Imf::ZIPS_COMPRESSION}, {"zip", Imf::ZIP_COMPRESSION},
                                             {"piz", Imf::PIZ_COMPRESSION},   {"pxr24", Imf::PXR24_COMPRESSION},
                                             {"b44", Imf::B44_COMPRESSION},   {"b44a", Imf::B44A_COMPRESSION},
                                             {"dwaa", Imf::DWAA_COMPRESSION}, {"dwab", Imf::DWAB_COMPRESSION}};

const NamedCompression* find_compression(std::string_view name) {
  return std::ranges::find(compressions, name, &NamedCompression::name);
}

void set_compression(Imf::Header& header, const std::string& wanted) {
  const auto colon = wanted.find(':');
  const std::string name = wanted.substr(0, colon);
  header.compression() = name.empty() ? Imf::ZIP_COMPRESSION : find_compression(name)->compression;
  if (colon == std::string::npos) return;
  const int level = std::stoi(wanted.substr(colon + 1));
  if (name.starts_with("zip"))
    header.zipCompressionLevel() = level;
  else
    header.dwaCompressionLevel() = float(level);
}

Imf::Header header_of(const ImagePlan& plan) {
  Imf::Header header(plan.levels[0].width, plan.levels[0].height);
  if (plan.rows) header.dataWindow().min.y = plan.rows->begin, header.dataWindow().max.y = plan.rows->end - 1;
  for (const char* channel : channels)
    header.channels().insert(channel, Imf::Channel(plan.depth == Depth::half ? Imf::HALF : Imf::FLOAT));
  if (plan.distances) header.channels().insert(depth_channel, Imf::Channel(Imf::FLOAT));
  set_compression(header, plan.compression);
  for (const auto& [name, text] : plan.attributes)
    header.insert(name == description ? "comments" : name == copyright ? "owner" : name, Imf::StringAttribute(text));
  if (const auto& luminance = plan.provenance.white_luminance) Imf::addWhiteLuminance(header, *luminance);
  if (const auto& c = plan.provenance.chromaticities)
    Imf::addChromaticities(header, {{(*c)[0], (*c)[1]}, {(*c)[2], (*c)[3]}, {(*c)[4], (*c)[5]}, {(*c)[6], (*c)[7]}});
  if (plan.latlong_envmap) Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  if (plan.cube_envmap) Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  if (plan.levels.size() > 1)
    header.setTileDescription(Imf::TileDescription(tile_size, tile_size, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN));
  return header;
}

// Three channels of which the first value, of row `begin`, lies at `first`.
Imf::FrameBuffer frame(Imf::PixelType type, const void* first, int begin, int width) {
  const std::size_t value = type == Imf::HALF ? 2 : 4, line = 3 * value * std::size_t(width);
  char* origin = static_cast<char*>(const_cast<void*>(first)) - std::ptrdiff_t(line) * begin;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < 3; ++c) buffer.insert(channels[c], Imf::Slice(type, origin + c * value, 3 * value, line));
  return buffer;
}

const void* as_stored(ExrOut& file, std::span<const Colour> rows) {
  if (file.type == Imf::FLOAT) return rows.data();
  const std::span<const float> from(&rows.data()->x, 3 * rows.size());
  file.halves.resize(from.size());
  constexpr std::size_t share = 1 << 15;
  parallel_for(int((from.size() + share - 1) / share), [&](int k) {
    const std::size_t first = std::size_t(k) * share, count = std::min(share, from.size() - first);
    to_half(from.subspan(first, count), std::span(file.halves).subspan(first, count));
  });
  return file.halves.data();
}

void write_rows(ExrOut& file, const ImagePlan& plan, int level, int begin, int end, std::span<const Colour> rows) {
  const int width = plan.levels[std::size_t(level)].width;
  Imf::FrameBuffer buffer = frame(file.type, as_stored(file, rows), begin, width);
  if (plan.distances) {
    file.distances.resize(rows.size());
    plan.distances(begin, end, file.distances);
    float* const origin = file.distances.data() - std::ptrdiff_t(width) * begin;
    buffer.insert(depth_channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(origin), 4, 4 * std::size_t(width)));
  }
  if (file.lines) {
    file.lines->setFrameBuffer(buffer);
    file.lines->writePixels(end - begin);
  } else {
    file.tiles->setFrameBuffer(buffer);
    file.tiles->writeTiles(0, (width - 1) / tile_size, begin / tile_size, (end - 1) / tile_size, level);
  }
}

template <class F>
void or_output_error(F&& action) {
  try {
    action();
  } catch (const Iex::BaseExc& e) {
    throw OutputError(plain(e.what()));
  }
}

}  // namespace

bool is_compression(std::string_view name) { return find_compression(name) != std::end(compressions); }

ImageWriter create_openexr(OutputFile& out, const ImagePlan& plan) {
  use_our_threads();
  const auto file = std::make_shared<ExrOut>(out, plan.depth == Depth::half ? Imf::HALF : Imf::FLOAT);
  or_output_error([&] {
    if (plan.levels.size() > 1)
      file->tiles.emplace(file->stream, header_of(plan));
    else
      file->lines.emplace(file->stream, header_of(plan));
  });
  return {.write =
              [file, plan](int level, int begin, int end, std::span<const Colour> rows) {
                or_output_error([&] { write_rows(*file, plan, level, begin, end, rows); });
              },
          .close =
              [file] {
                or_output_error([&] {
                  file->lines.reset();
                  file->tiles.reset();
                });
              }};
}

}  // namespace envmap
