// The readers of images that are ours, each alone; fuzz_read goes through all of them, and through files and pipes.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/formats/babylon_env.h"
#include "envmap/io/formats/ktx.h"
#include "envmap/io/images/open_image.h"
#include "targets.h"

using namespace envmap;

namespace {

std::string_view mark_of(std::string_view format) {
  if (format == "hdr") return "#?";
  if (format == "exr") return "\x76\x2f\x31\x01";
  if (format == "ktx") return ktx1_mark;
  if (format == "env") return env_mark;
  if (format == "glb") return "glTF";
  if (format == "png") return "\x89PNG";
  if (format == "jpg") return "\xff\xd8";
  if (format == "tif") return "II";
  if (format == "pfm") return "P";
  return format == "ktx2" ? ktx2_mark : "DDS ";
}

constexpr std::int64_t most = 1 << 20;  // Texels that are looked at.

void read_texture_levels(const Image& image) {
  const TextureFile& t = *image.texture;
  for (int k = 0; k < t.levels; ++k) {
    const TexelFormat format = t.format();
    const int width = t.level_width(k), height = t.level_height(k), faces = t.cube ? 6 : 1;
    if (std::int64_t{width} * height * faces > most) continue;
    const std::vector<std::byte> stored = t.bytes(*image.file, k);
    if (stored.size() != std::uint64_t(faces) * t.image_bytes(k)) std::abort();
    std::vector<Colour> out(std::size_t(width * format.side));
    for (std::size_t at = 0; at < stored.size(); at += format.row_bytes(width))
      if (t.packing.bytes > 0)
        (void)decode(t.packing, std::span(stored).subspan(at, format.row_bytes(width)), out);
      else
        (void)decode(t.texels, std::span(stored).subspan(at, format.row_bytes(width)), out);
  }
}

// As values are where a row is read.
void decode(const Image& image, std::span<const float> row) {
  const auto& colour = image.reader->facts.colour;
  if (!colour || !colour->decode) return;
  std::vector<Colour> colours;
  for (std::size_t k = 0; k + 2 < row.size(); k += 3) colours.emplace_back(row[k], row[k + 1], row[k + 2]);
  colour->decode(colours);
}

void read_image_levels(const Image& image) {
  for (int k = 0; k < 32; ++k) {
    const auto facts = image.reader->level_facts(k);
    if (!facts) break;
    const int channels = std::min<int>(3, int(facts->channels.size()));
    const int unit = facts->tile_height > 0 ? facts->tile_height : 16;
    if (facts->width < 1 || facts->height < 1 || channels < 1 || !facts->flat || unit > 4096 ||
        facts->tile_width > 4096 || std::int64_t{facts->width} * std::max(facts->height, unit) > most)
      continue;
    std::vector<float> rows(std::size_t(facts->width) * std::size_t(unit * channels));
    for (int begin = 0; begin < facts->height; begin += unit) {
      const int end = std::min(begin + unit, facts->height);
      image.reader->read(k, begin, end, 0, channels,
                         std::span(rows).first(std::size_t(facts->width) * std::size_t((end - begin) * channels)));
      decode(image, rows);
    }
  }
}

}  // namespace

void fuzz_image(std::string_view format, Bytes bytes) {
  const std::string_view mark = mark_of(format);
  const auto* const data = reinterpret_cast<const char*>(bytes.data());
  std::vector<char> file(data, data + bytes.size());
  file.resize(std::max(file.size(), mark.size()));
  std::ranges::copy(mark, file.begin());
  Image image;
  try {
    open_bytes(image, "image", std::move(file));
  } catch (const InputError& e) {
    return expect_harmless(e.what());
  }
  try {
    image.texture ? read_texture_levels(image) : read_image_levels(image);
  } catch (const InputError&) {  // Its words become harmless in read().
  }
}
