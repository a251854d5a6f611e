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

bool is_float(const Names& n) { return n.type == floats || n.type == halves; }

// Type and format say how texels lie in the file, where they are there: texturec of bgfx leaves them 0, and then the
// internal format says it.
Texels texels_in(const Header& h) {
  const auto* found = std::ranges::find(names, h.internal, &Names::internal);
  if (found == std::end(names))
    throw InputError(
        fmt::format("not supported: KTX with glInternalFormat 0x{:x}: only RGB as sized bytes, floats, RGB9_E5, "
                    "R11F_G11F_B10F or BPTC floats is read",
                    h.internal));
  if (h.type == 0 && (h.format == 0 || h.format == found->format || h.format == h.internal)) return found->texels;
  if (h.type != found->type && is_float(*found))
    found = std::ranges::find_if(names, [&](const Names& n) { return n.type == h.type && n.format == found->format; });
  if (found == std::end(names) || h.type != found->type)
    throw InputError(
        fmt::format("not supported: KTX with glType 0x{:x} and glInternalFormat 0x{:x}", h.type, h.internal));
  // Early versions of Filament's cmgen wrote the internal format here, too.
  if (h.format != found->format && h.format != h.internal)
    throw InputError(
        fmt::format("not supported: KTX with glFormat 0x{:x} and glInternalFormat 0x{:x}: the channels "
                    "must be in their order",
                    h.format, h.internal));
  return found->texels;
}

// Where images of a level lie, and how far their rows and they themselves are apart.
struct LevelPlace {
  std::uint64_t offset, row_bytes, face_bytes;
};

// What writers make of the rule that rows and images fill words. Each names the size of an image otherwise than it
// pads it.
enum class Padding {
  as_specified,
  images,             // Rows are not padded.
  none,               // Not even images are.
  beside_their_size,  // cmft: rows are, but the size is that without; images are padded by what that one lacks.
};

// @param tight bytes of a row. @param rows of an image.
struct Sizes {
  std::uint64_t said, row, face, level;
};
Sizes sizes_of(Padding padding, std::uint64_t tight, std::uint64_t rows, std::uint64_t faces) {
  const std::uint64_t bare = rows * tight, whole = rows * padded(tight);
  switch (padding) {
    case Padding::as_specified: return {whole, padded(tight), whole, faces * whole};
    case Padding::images: return {bare, tight, padded(bare), faces * padded(bare)};
    case Padding::none: return {bare, tight, bare, faces * bare};
    case Padding::beside_their_size: break;
  }
  const std::uint64_t face = whole + padded(bare) - bare, all = faces * bare;
  return {bare, padded(tight), face, faces * face + padded(all) - all};
}

struct Places {
  std::vector<LevelPlace> levels = {};
  std::uint64_t end = 0;
  std::string contradiction = {};  // Between a size in the file and what it must be.
};

// @param start of the first level.
Places places_of(const InputFile& file, const TextureFile& t, Padding padding, std::uint64_t start) {
  Places found{.end = start};
  for (int k = 0; k < t.levels; ++k) {
    const auto said = read_as<std::uint32_t>(file, found.end);
    const std::uint64_t tight = t.format().row_bytes(t.level_width(k)), rows = t.image_bytes(k) / tight;
    const Sizes sizes = sizes_of(padding, tight, rows, t.cube ? 6 : 1);
    if (said != sizes.said) {
      found.contradiction = fmt::format("damaged: level {} has images of {} bytes, not {}", k, said, sizes.said);
      break;
    }
    found.levels.push_back({found.end + 4, sizes.row, sizes.face});
    found.end += 4 + sizes.level;
  }
  return found;
}

// The length of the file tells how it is padded. What is behind the last texel may be missing.
std::vector<LevelPlace> find_levels(const InputFile& file, const TextureFile& t, std::uint64_t start) {
  constexpr Padding all[] = {Padding::as_specified, Padding::images, Padding::none, Padding::beside_their_size};
  std::vector<Places> found;
  for (const Padding padding : all) {
    try {
      found.push_back(places_of(file, t, padding, start));
    } catch (const InputError&) {  // It ends before the size of a level.
      if (padding == Padding::as_specified) throw;
    }
  }
  for (const std::uint64_t missing : {0, 1, 2, 3})
    for (const Places& p : found)
      if (p.contradiction.empty() && p.end == file.size() + missing) return p.levels;

  const std::string contradiction = found.front().contradiction;
  std::erase_if(found, [](const Places& p) { return !p.contradiction.empty(); });
  if (found.empty()) throw InputError(contradiction);
  std::ranges::sort(found, {}, &Places::end);
  const std::uint64_t end = found.front().end;
  if (end > file.size())
    throw InputError(fmt::format("truncated or damaged: its levels end at {}, the file at {}", end, file.size()));
  throw InputError(
      fmt::format("not supported: KTX whose sizes leave {} bytes over: write it by a program that pads rows "
                  "and images to words",
                  file.size() - end));
}

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
    throw InputError(h.endianness == big ? "not supported: KTX of a big-endian machine: little-endian words are read"
                                         : "damaged: KTX with words of neither byte order");
  const Texels texels = texels_in(h);
  if (h.depth > 1 || h.elements > 1 || (h.faces != 1 && h.faces != 6))
    throw InputError(fmt::format(
        "not supported: KTX of depth {}, {} array elements and {} faces: one flat image or one cube map is read",
        h.depth, h.elements, h.faces));
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
    t.claims.push_back({.name = "KTXorientation", .value = o->second});
    if (!o->second.starts_with("S=r,T=d") && (!t.bottom_up || t.cube))
      throw InputError(
          fmt::format("not supported: KTX of orientation '{}': 'S=r,T=d' is read, and 'S=r,T=u' of flat images",
                      o->second));
  }
  t.recorded = recorded(pairs);

  const std::vector<LevelPlace> places = find_levels(file, t, sizeof(Header) + h.pairs_size);
  t.bytes = [t, places](const InputFile& from, int level) {
    const LevelPlace place = places[std::size_t(level)];
    const std::uint64_t tight = t.format().row_bytes(t.level_width(level)), rows = t.image_bytes(level) / tight;
    std::vector<std::byte> bytes;
    for (std::uint64_t face = 0; face < (t.cube ? 6 : 1); ++face) {
      const auto image = read_bytes(from, place.offset + face * place.face_bytes, (rows - 1) * place.row_bytes + tight);
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
