#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/bands.h"
#include "envmap/io/containers.h"
#include "envmap/io/key_values.h"
#include "envmap/io/write_plan.h"

namespace envmap {
namespace {

// Section 2, "File Structure": what comes first in a file.
struct Header {
  std::array<char, 12> identifier;
  std::uint32_t endianness, type, type_size, format, internal, base, width, height, depth, elements, faces, levels,
      pairs_size;
};
static_assert(sizeof(Header) == 64);

constexpr std::uint32_t little = 0x04030201, big = 0x01020304;

// What OpenGL calls a format. Sources: OpenGL 4.6, tables 8.2, 8.3, 8.12 and 8.14,
// and the numbers of the registry's gl.xml.
struct Names {
  Texels texels;
  std::uint32_t internal, format, type;
};
constexpr std::uint32_t rgb = 0x1907, rgba = 0x1908, ubyte = 0x1401, floats = 0x1406, halves = 0x140b;
constexpr Names names[] = {
    {Texels::rgba16f, 0x881a, rgba, halves}, {Texels::rgba32f, 0x8814, rgba, floats},
    {Texels::rgb9e5, 0x8c3d, rgb, 0x8c3e},   {Texels::rgb16f, 0x881b, rgb, halves},
    {Texels::rgb32f, 0x8815, rgb, floats},   {Texels::rg11b10f, 0x8c3a, rgb, 0x8c3b},
    {Texels::bc6h_ufloat, 0x8e8f, 0, 0},     {Texels::bc6h_sfloat, 0x8e8e, 0, 0},
    {Texels::rgb8, 0x8051, rgb, ubyte},      {Texels::rgb8_srgb, 0x8c41, rgb, ubyte},
    {Texels::rgba8, 0x8058, rgba, ubyte},    {Texels::rgba8_srgb, 0x8c43, rgba, ubyte},
};

// Without alpha: Filament takes no floats that have one.
Texels without_alpha(Texels texels) {
  return texels == Texels::rgba16f ? Texels::rgb16f : texels == Texels::rgba32f ? Texels::rgb32f : texels;
}

// Rows fill words.
std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }

// Texels by their internal format; what lies in the file must be of the same kind.
Texels texels_in(const Header& h) {
  const auto* found = std::ranges::find(names, h.internal, &Names::internal);
  if (found == std::end(names))
    throw InputError(
        fmt::format("KTX with glInternalFormat 0x{:x}: only RGB as sized bytes, floats, RGB9_E5, R11F_G11F_B10F or "
                    "BPTC floats is read",
                    h.internal));
  if (h.type != found->type)
    throw InputError(fmt::format("damaged: KTX with glType 0x{:x} and glInternalFormat 0x{:x}", h.type, h.internal));
  // Early versions of Filament's cmgen wrote the internal format here, too.
  if (h.format != found->format && h.format != h.internal)
    throw InputError(
        fmt::format("KTX with glFormat 0x{:x} and glInternalFormat 0x{:x}: the channels must be in their order",
                    h.format, h.internal));
  return found->texels;
}

// Where images of a level lie, and how far their rows are apart: of what the specification says, rows fill words.
struct LevelPlace {
  std::uint64_t offset, row_bytes;
};

}  // namespace

void write_ktx1(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  const Texels texels = without_alpha(plan.texels);
  const TexelFormat& format = format_of(texels);
  const Names& gl = *std::ranges::find(names, texels, &Names::texels);
  KeyValues pairs = key_values(plan.data, plan.pairs);
  pairs.emplace("KTXorientation", "S=r,T=d");
  const std::string kvd = key_value_bytes(pairs);
  Header h{};
  std::ranges::copy(ktx1_mark, h.identifier.begin());
  h.endianness = little;
  h.type = gl.type;
  h.type_size = format.type_size;
  h.format = gl.format;
  h.internal = gl.internal;
  h.base = rgb;
  h.width = std::uint32_t(levels[0].width());
  h.height = plan.cube ? h.width : std::uint32_t(levels[0].height());
  h.faces = plan.cube ? 6 : 1;
  h.levels = std::uint32_t(levels.size());
  h.pairs_size = std::uint32_t(kvd.size());
  file.put(&h, sizeof h);
  file.put(kvd.data(), kvd.size());

  Shares shares(progress, levels);
  for (const Atlas& atlas : levels) {
    const std::vector<Atlas> images = images_of(atlas, plan.cube);
    // Of a cube it is the size of one face.
    const std::uint64_t row = format.row_bytes(images[0].width());
    const std::uint64_t size = format.image_bytes(images[0].width(), images[0].height()) / row * padded(row);
    if (size > 0xffffffff) throw OutputError(fmt::format("KTX holds images of up to 4 GiB, not of {} bytes", size));
    const auto image_size = std::uint32_t(size);
    file.put(&image_size, sizeof image_size);
    encode_images(format, images, shares, [&](std::span<const std::byte> packed) {
      if (padded(row) == row) {
        file.put(packed.data(), packed.size());
        return;
      }
      for (std::size_t at = 0; at < packed.size(); at += row) {
        file.put(packed.data() + at, row);
        file.put("\0\0", padded(row) - row);
      }
    });
  }
}

TextureFile open_ktx1(const InputFile& file) {
  const auto h = read_as<Header>(file, 0);
  if (h.endianness != little)
    throw InputError(h.endianness == big ? "KTX of a big-endian machine: little-endian words are read"
                                         : "damaged: KTX with words of neither byte order");
  const Texels texels = texels_in(h);
  if (h.depth > 1 || h.elements > 1 || (h.faces != 1 && h.faces != 6))
    throw InputError(
        fmt::format("KTX of depth {}, {} array elements and {} faces: one flat image or one cube map is read", h.depth,
                    h.elements, h.faces));
  constexpr std::uint32_t most = 0x7fffffff;
  TextureFile t{.container = "ktx",
                .texels = texels,
                .width = int(std::min(h.width, most)),
                .height = int(std::min(h.height, most)),
                .levels = int(std::clamp(h.levels, 1U, most)),
                .cube = h.faces == 6};
  check_texture(t, file.size());
  const KeyValues pairs = parse_key_values(read_bytes(file, sizeof(Header), h.pairs_size));
  if (const auto o = pairs.find("KTXorientation"); o != pairs.end()) {
    t.bottom_up = o->second.starts_with("S=r,T=u");
    if (!o->second.starts_with("S=r,T=d") && (!t.bottom_up || t.cube))
      throw InputError(
          fmt::format("KTX of orientation '{}': 'S=r,T=d' is read, and 'S=r,T=u' of flat images", o->second));
  }
  t.recorded = recorded(pairs);

  std::vector<LevelPlace> places;
  std::uint64_t at = sizeof(Header) + h.pairs_size;
  for (int k = 0; k < t.levels; ++k) {
    const auto size = read_as<std::uint32_t>(file, at);
    const std::uint64_t tight = format_of(texels).row_bytes(t.level_width(k)), rows = t.image_bytes(k) / tight,
                        faces = t.cube ? 6 : 1;
    // Some writers leave the padding of rows out.
    const std::uint64_t row = size == rows * padded(tight) ? padded(tight) : tight;
    if (size != rows * row)
      throw InputError(fmt::format("damaged: level {} has images of {} bytes, not {}", k, size, rows * padded(tight)));
    places.push_back({at + 4, row});
    at += 4 + faces * padded(size);
  }
  t.bytes = [t, places](const InputFile& from, int level) {
    const LevelPlace place = places[std::size_t(level)];
    const std::uint64_t tight = format_of(t.texels).row_bytes(t.level_width(level)),
                        rows = t.image_bytes(level) / tight;
    std::vector<std::byte> bytes;
    for (std::uint64_t face = 0; face < (t.cube ? 6 : 1); ++face) {
      const auto image = read_bytes(from, place.offset + face * padded(rows * place.row_bytes), rows * place.row_bytes);
      for (std::uint64_t row = 0; row < rows; ++row) {
        const auto begin = image.begin() + std::ptrdiff_t(row * place.row_bytes);
        bytes.insert(bytes.end(), begin, begin + std::ptrdiff_t(tight));
      }
    }
    return bytes;
  };
  return t;
}

}  // namespace envmap
