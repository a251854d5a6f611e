#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/half.h"
#include "envmap/io/openexr.h"
#include "envmap/io/openexr_stream.h"

namespace envmap {
namespace {

constexpr const char* channels[] = {"R", "G", "B"};
constexpr const char* depth_channel = "Z";

// A file being written; `lines` or `tiles` is set.
struct File {
  ExrOutput stream;
  Imf::PixelType type;
  std::optional<Imf::OutputFile> lines = {};
  std::optional<Imf::TiledOutputFile> tiles = {};
  std::vector<std::uint16_t> halves = {};
  std::vector<float> distances = {};

  File(OutputFile& out, Imf::PixelType t) : stream(out), type(t) {}
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

const void* as_stored(File& file, std::span<const Colour> rows) {
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

void write_rows(File& file, const ImagePlan& plan, int level, int begin, int end, std::span<const Colour> rows) {
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
  const auto file = std::make_shared<File>(out, plan.depth == Depth::half ? Imf::HALF : Imf::FLOAT);
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
