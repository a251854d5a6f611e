#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <memory>

#include "envmap/base/error.h"
#include "envmap/base/split.h"
#include "envmap/base/words.h"
#include "envmap/io/check_tiles.h"
#include "envmap/io/openexr.h"
#include "envmap/io/openexr_stream.h"
#include "envmap/io/window.h"

namespace envmap {
namespace {

// An opened file and one part of it, of which one reader is set once pixels have been asked for.
struct File {
  ExrInput stream;
  ExrParts parts;
  int part = 0;
  std::vector<bool> inverted = {};  // For each chosen channel, whether it was asked for as 1/NAME.
  ExrInput again;                   // For the reader of luminance and chroma.
  std::optional<Imf::InputPart> lines = {};
  std::optional<Imf::TiledInputPart> tiles = {};
  std::optional<Imf::RgbaInputFile> luminance = {};

  explicit File(const InputFile& file) : stream(file), parts(stream), again(file) {}
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
  // Of our own making: a file that was converted may carry the word without the attribute.
  texts.erase("textureformat");
  if (Imf::hasEnvmap(header))
    texts["textureformat"] = Imf::envmap(header) == Imf::ENVMAP_CUBE ? "CubeFace Environment" : "LatLong Environment";
  return texts;
}

Provenance colours_of(const Imf::Header& header) {
  Provenance p;
  if (Imf::hasWhiteLuminance(header) && std::isfinite(Imf::whiteLuminance(header)))
    p.white_luminance = Imf::whiteLuminance(header);
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
std::optional<ImageFacts> level_facts(const File& file, ImageFacts f, int level) {
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
Imf::FrameBuffer frame(const File& file, const ImageFacts& f, int begin, int first, int count, float* out) {
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

void read_tiles(File& file, const Imf::FrameBuffer& buffer, const ImageFacts& f, int level, int begin, int end) {
  if (!file.tiles) file.tiles.emplace(file.parts, file.part);
  file.tiles->setFrameBuffer(buffer);
  file.tiles->readTiles(0, (f.width - 1) / f.tile_width, begin / f.tile_height, (end - 1) / f.tile_height, level,
                        level);
}

void read_lines(File& file, const Imf::FrameBuffer& buffer, int begin, int end) {
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

void read_rows(File& file, const ImageFacts& facts, int level, int begin, int end, int first, int count,
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

void choose_part(File& file, const std::string& wanted, ImageFacts& facts) {
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
std::vector<std::string> choose_channels(File& file, const ImageChoice& choice, ImageFacts& facts) {
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

void read_luminance(File& file, const ImageFacts& f, int begin, int end, int first, int count, std::span<float> out) {
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
  std::shared_ptr<File> file;
  try {
    file = std::make_shared<File>(bytes);
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

}  // namespace envmap
