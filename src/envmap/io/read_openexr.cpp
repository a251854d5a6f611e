#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <memory>

#include "envmap/base/error.h"
#include "envmap/io/openexr.h"
#include "envmap/io/openexr_stream.h"

namespace envmap {
namespace {

// An opened file and its first part, of which one is set once pixels have been asked for.
struct File {
  ExrInput stream;
  Imf::MultiPartInputFile parts;
  std::optional<Imf::InputPart> lines = {};
  std::optional<Imf::TiledInputPart> tiles = {};

  explicit File(const InputFile& file) : stream(file), parts(stream) {}
  [[nodiscard]] const Imf::Header& header() const { return parts.header(0); }
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
      texts.emplace(std::string_view(a.name()) == "comments" ? description : a.name(), text->value());
  // Of our own making: a file that was converted may carry the word without the attribute.
  texts.erase("textureformat");
  if (Imf::hasEnvmap(header))
    texts["textureformat"] = Imf::envmap(header) == Imf::ENVMAP_CUBE ? "CubeFace Environment" : "LatLong Environment";
  return texts;
}

ImageFacts facts_of(const Imf::Header& header) {
  const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
  ImageFacts f{.width = static_cast<int>(std::min<std::int64_t>(1L + data.max.x - data.min.x, INT_MAX)),
               .height = static_cast<int>(std::min<std::int64_t>(1L + data.max.y - data.min.y, INT_MAX)),
               .flat = !header.hasType() || !Imf::isDeepData(header.type()),
               .whole = data == display,
               .depth = Depth::half,
               .channels = channel_names(header.channels()),
               .attributes = attributes_of(header)};
  if (in_tiles(header)) {
    f.tile_width = static_cast<int>(std::min<unsigned>(header.tileDescription().xSize, INT_MAX));
    f.tile_height = static_cast<int>(std::min<unsigned>(header.tileDescription().ySize, INT_MAX));
  }
  const std::size_t colours = std::min<std::size_t>(f.channels.size(), 3);
  for (std::size_t k = 0; k < colours; ++k)
    if (header.channels()[f.channels[k]].type != Imf::HALF) f.depth = Depth::single;
  return f;
}

// The same of a smaller level.
std::optional<ImageFacts> level_facts(File& file, int level) {
  const Imf::Header& header = file.header();
  ImageFacts f = facts_of(header);
  if (level == 0) return f;
  if (!in_tiles(header) || header.tileDescription().mode != Imf::MIPMAP_LEVELS) return std::nullopt;
  const bool up = header.tileDescription().roundingMode == Imf::ROUND_UP;
  const int longer = std::max(f.width, f.height);
  if (level > 30 || (up ? (longer - 1) >> (level - 1) : longer >> level) == 0) return std::nullopt;
  const auto side = [&](int n) { return std::max(1, static_cast<int>((n + (up ? (1L << level) - 1 : 0)) >> level)); };
  f.width = side(f.width), f.height = side(f.height);
  return f;
}

// Where the channels of an image go: (0, 0) of the window is at its place in the file.
Imf::FrameBuffer frame(const File& file, const ImageFacts& f, int begin, int first, int count, float* out) {
  const Imath::Box2i window = file.header().dataWindow();
  const auto pixel = static_cast<std::ptrdiff_t>(sizeof(float)) * count, line = pixel * f.width;
  char* origin = reinterpret_cast<char*>(out) - pixel * window.min.x - line * (std::ptrdiff_t{window.min.y} + begin);
  Imf::FrameBuffer buffer;
  for (int c = 0; c < count; ++c) {
    const std::string& name = f.channels[static_cast<std::size_t>(first + c)];
    const Imf::Channel& channel = file.header().channels()[name];
    if (channel.type == Imf::UINT) throw InputError(fmt::format("channel {} holds whole numbers, not radiance", name));
    if (channel.xSampling != 1 || channel.ySampling != 1)
      throw InputError(fmt::format("channel {} is not sampled in every pixel", name));
    buffer.insert(name, Imf::Slice(Imf::FLOAT, origin + static_cast<std::ptrdiff_t>(sizeof(float)) * c,
                                   static_cast<std::size_t>(pixel), static_cast<std::size_t>(line)));
  }
  return buffer;
}

void read_tiles(File& file, const Imf::FrameBuffer& buffer, const ImageFacts& f, int level, int begin, int end) {
  if (!file.tiles) file.tiles.emplace(file.parts, 0);
  file.tiles->setFrameBuffer(buffer);
  file.tiles->readTiles(0, (f.width - 1) / f.tile_width, begin / f.tile_height, (end - 1) / f.tile_height, level, level);
}

void read_lines(File& file, const Imf::FrameBuffer& buffer, int begin, int end) {
  if (!file.lines) file.lines.emplace(file.parts, 0);
  const int top = file.header().dataWindow().min.y;
  file.lines->setFrameBuffer(buffer);
  file.lines->readPixels(top + begin, top + end - 1);
}

void read_rows(File& file, int level, int begin, int end, int first, int count, std::span<float> out) {
  const ImageFacts f = *level_facts(file, level);
  const Imf::FrameBuffer buffer = frame(file, f, begin, first, count, out.data());
  try {
    if (f.tile_width > 0)
      read_tiles(file, buffer, f, level, begin, end);
    else
      read_lines(file, buffer, begin, end);
  } catch (const Iex::BaseExc& e) {
    throw InputError(plain(e.what()));
  }
}

}  // namespace

ImageReader open_openexr(const InputFile& bytes) {
  use_our_threads();
  std::shared_ptr<File> file;
  try {
    file = std::make_shared<File>(bytes);
  } catch (const Iex::BaseExc& e) {
    throw InputError(plain(e.what()));
  }
  return {.format = "openexr",
          .facts = facts_of(file->header()),
          .level = [file](int level) { return level_facts(*file, level); },
          .read = [file](int level, int begin, int end, int first, int count,
                         std::span<float> out) { read_rows(*file, level, begin, end, first, count, out); }};
}

}  // namespace envmap
