// KTX and KTX2 of Khronos.
#include "envmap/io/formats/ktx.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <numeric>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/images/bands.h"
#include "envmap/io/write_plan.h"

namespace envmap {

// KTX of 2010.

namespace {

// Section 2, "File Structure": what comes first in a file.
struct Ktx1Header {
  std::array<char, 12> identifier;
  std::uint32_t endianness, type, type_size, format, internal, base, width, height, depth, elements, faces, levels,
      pairs_size;
};
static_assert(sizeof(Ktx1Header) == 64);

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
Texels texels_in(const Ktx1Header& h) {
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
  Ktx1Header h{};
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

  PartsOfProgress shares(progress, levels);
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
  const auto h = read_as<Ktx1Header>(file, 0);
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
  const KeyValues pairs = parse_key_values(read_bytes(file, sizeof(Ktx1Header), h.pairs_size));
  if (const auto o = pairs.find("KTXorientation"); o != pairs.end()) {
    t.bottom_up = o->second.starts_with("S=r,T=u");
    t.claims.push_back({.name = "KTXorientation", .value = o->second});
    if (!o->second.starts_with("S=r,T=d") && (!t.bottom_up || t.cube))
      throw InputError(
          fmt::format("not supported: KTX of orientation '{}': 'S=r,T=d' is read, and 'S=r,T=u' of flat images",
                      o->second));
  }
  t.recorded = recorded(pairs);

  const std::vector<LevelPlace> places = find_levels(file, t, sizeof(Ktx1Header) + h.pairs_size);
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

// KTX2.

namespace {

// Section 3, "File Structure": what comes first in a file.
struct Ktx2Header {
  std::array<char, 12> identifier;
  std::uint32_t vk_format, type_size, width, height, depth, layers, faces, levels, scheme;
  std::uint32_t dfd_offset, dfd_size, kvd_offset, kvd_size;
  std::uint64_t sgd_offset, sgd_size;
};
static_assert(sizeof(Ktx2Header) == 80);

struct LevelIndex {
  std::uint64_t offset, size, plain_size;
};

// KHR_DF_PRIMARIES_BT709.
constexpr std::uint8_t rec709_primaries = 1;

enum Scheme : std::uint32_t { plain = 0, zstandard = 2 };

// ---- data format descriptor -----------------------------------------------------------------------------------------

using Words = std::vector<std::uint32_t>;

// The colour model of Basis Universal's part of ASTC, whose VkFormat is ASTC's.
constexpr std::uint32_t uastc_hdr_4x4 = 167;

// A sample of a basic descriptor block: which bits hold a channel, and what the least and largest of them mean.
void add_sample(Words& words, unsigned offset, unsigned length, unsigned channel_type, std::uint32_t lower,
                std::uint32_t upper) {
  words.insert(words.end(), {offset | (length - 1) << 16 | channel_type << 24, 0, lower, upper});
}

// Texel by texel or, of BC6H and UASTC HDR, block by block. E5B9G9R9's limits are those of the Data Format
// Specification 1.4, table 105: the shared exponent counts for each channel.
Words descriptor(const TexelFormat& format, KhrColour colour) {
  constexpr unsigned is_float = 0x80, is_signed = 0x40, is_exponent = 0x20, alpha = 15;
  constexpr std::uint32_t one = 0x3f800000, minus_one = 0xbf800000;  // As floats.
  constexpr std::uint32_t rgbsda = 1, bc6h = 133;
  const std::uint32_t model = format.depth == Depth::bc6h        ? bc6h
                              : format.depth == Depth::uastc_hdr ? uastc_hdr_4x4
                                                                 : rgbsda;
  const std::uint32_t side = std::uint32_t(format.side) - 1;
  const std::uint32_t primaries = colour.primaries, transfer = colour.transfer;
  Words words{0, 0, 0, model | primaries << 8 | transfer << 16, side | side << 8, std::uint32_t(format.bytes), 0};
  if (model != rgbsda) {
    const bool is_negative = format.texels == Texels::bc6h_sfloat;
    add_sample(words, 0, 128, is_float | (is_negative ? is_signed : 0), is_negative ? minus_one : 0, one);
  } else if (format.texels == Texels::rgb9e5) {
    for (unsigned c = 0; c < 3; ++c) {
      add_sample(words, 9 * c, 9, c, 0, 8448);
      add_sample(words, 27, 5, c | is_exponent, 15, 31);
    }
  } else {
    const auto channels = unsigned(format.channels), bits = unsigned(8 * format.bytes) / channels;
    for (unsigned c = 0; c < channels; ++c)
      add_sample(words, c * bits, bits, (c == 3 ? alpha : c) | is_float | is_signed, minus_one, one);
  }
  const auto size = std::uint32_t(4 * words.size());
  words[0] = size;
  words[2] = 2 | (size - 4) << 16;  // Version 1.3 and later; size of the block.
  return words;
}

// Bytes 13 and 14 of the descriptor behind its size; of a descriptor that is cut nothing.
KhrColour described_colour(const InputFile& file, const Ktx2Header& h) {
  if (h.dfd_size < 16 || std::uint64_t{h.dfd_offset} + h.dfd_size > file.size()) return {};
  const auto word = read_as<std::uint32_t>(file, h.dfd_offset + 12U);
  return {std::uint8_t(word >> 8), std::uint8_t(word >> 16)};
}

// VkFormat says that it is ASTC HDR, of which one part is read.
void require_uastc_hdr(const InputFile& file, const Ktx2Header& h) {
  if (h.vk_format != format_of(Texels::uastc_hdr).vulkan) return;
  const std::uint32_t model = h.dfd_size < 16 ? 0 : read_as<std::uint32_t>(file, h.dfd_offset + 12U) & 0xff;
  if (model != uastc_hdr_4x4)
    throw InputError(fmt::format(
        "not supported: KTX2 of ASTC HDR with colour model {}: of ASTC only UASTC HDR 4x4 (model {}) is read", model,
        uastc_hdr_4x4));
}

// ---- levels ---------------------------------------------------------------------------------------------------------

// Texels on their way to the file, through Zstandard where that is asked for. One worker gives the bytes that any
// number of workers gives; none would give others.
class LevelWriter {
 public:
  LevelWriter(OutputFile& file, bool zstd) : file_(file), context_(zstd ? ZSTD_createCCtx() : nullptr, ZSTD_freeCCtx) {
    if (!zstd) return;
    if (!context_) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_nbWorkers, std::max(1, thread_limit()));
    packed_.resize(ZSTD_CStreamOutSize());
  }

  void begin(std::uint64_t size) {
    if (context_) ZSTD_CCtx_setPledgedSrcSize(context_.get(), size);
  }
  void write(std::span<const std::byte> bytes) {
    if (context_)
      compress(bytes, ZSTD_e_continue);
    else
      file_.put(bytes.data(), bytes.size());
  }
  void end() {
    if (context_) compress({}, ZSTD_e_end);
  }

 private:
  void compress(std::span<const std::byte> bytes, ZSTD_EndDirective directive) {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    for (bool more = true; more;) {
      ZSTD_outBuffer out{packed_.data(), packed_.size(), 0};
      const std::size_t left = ZSTD_compressStream2(context_.get(), &out, &in, directive);
      if (ZSTD_isError(left)) throw OutputError(fmt::format("not compressed: {}", ZSTD_getErrorName(left)));
      file_.put(packed_.data(), out.pos);
      more = directive == ZSTD_e_end ? left > 0 : in.pos < in.size;
    }
  }

  OutputFile& file_;
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context_;
  std::vector<char> packed_;
};

std::vector<std::byte> decompressed(std::span<const std::byte> packed, std::uint64_t size) {
  const auto fail = [](const std::string& why) { throw InputError("damaged: a level does not decompress: " + why); };
  if (const auto promised = ZSTD_getFrameContentSize(packed.data(), packed.size());
      promised == ZSTD_CONTENTSIZE_ERROR || (promised != ZSTD_CONTENTSIZE_UNKNOWN && promised > size))
    fail("not one Zstandard frame of its size");
  std::vector<std::byte> bytes(size);
  const std::size_t found = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(found)) fail(ZSTD_getErrorName(found));
  if (found != size) fail("it is too short");
  return bytes;
}

}  // namespace

void write_ktx2(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  const TexelFormat& format = format_of(plan.texels);
  const Words dfd = descriptor(format, plan.colour);
  KeyValues pairs = key_values(plan.data, plan.pairs);
  pairs.emplace("KTXorientation", "rd");
  const std::string kvd = key_value_bytes(pairs);
  Ktx2Header h{};
  std::ranges::copy(ktx2_mark, h.identifier.begin());
  h.vk_format = format.vulkan;
  h.type_size = format.type_size;
  h.width = std::uint32_t(levels[0].width());
  h.height = plan.cube ? h.width : std::uint32_t(levels[0].height());
  h.faces = plan.cube ? 6 : 1;
  h.levels = std::uint32_t(levels.size());
  h.scheme = plan.zstd ? zstandard : plain;
  h.dfd_offset = std::uint32_t(sizeof(Ktx2Header) + levels.size() * sizeof(LevelIndex));
  h.dfd_size = std::uint32_t(4 * dfd.size());
  h.kvd_offset = h.dfd_offset + h.dfd_size;
  h.kvd_size = std::uint32_t(kvd.size());

  PartsOfProgress shares(progress, levels);
  std::vector<LevelIndex> index(levels.size());
  LevelWriter out(file, plan.zstd);
  file.seek(h.kvd_offset + h.kvd_size);
  for (std::size_t k = levels.size(); k-- > 0;) {
    const std::vector<Atlas> images = images_of(levels[k], plan.cube);
    const auto align = plan.zstd ? 1 : std::lcm(std::int64_t(format.bytes), std::int64_t{4});
    file.seek((file.tell() + align - 1) / align * align);
    index[k].offset = std::uint64_t(file.tell());
    index[k].plain_size = images.size() * format.image_bytes(images[0].width(), images[0].height());
    out.begin(index[k].plain_size);
    encode_images(format, images, shares, [&](std::span<const std::byte> rows) { out.write(rows); });
    out.end();
    index[k].size = std::uint64_t(file.tell()) - index[k].offset;
  }
  file.seek(0);
  file.put(&h, sizeof h);
  file.put(index.data(), index.size() * sizeof(LevelIndex));
  file.put(dfd.data(), h.dfd_size);
  file.put(kvd.data(), kvd.size());
}

void write_ktx2_volume(OutputFile& file, const HalfVolume& volume, const KeyValues& pairs) {
  const TexelFormat& format = format_of(Texels::rgba16f);
  const Words dfd = descriptor(format, {.primaries = rec709_primaries, .transfer = khr_linear});
  const std::string kvd = key_value_bytes(pairs);
  Ktx2Header h{};
  std::ranges::copy(ktx2_mark, h.identifier.begin());
  h.vk_format = format.vulkan;
  h.type_size = format.type_size;
  h.width = std::uint32_t(volume.width);
  h.height = std::uint32_t(volume.height);
  h.depth = std::uint32_t(volume.depth);
  h.faces = h.levels = 1;
  h.dfd_offset = std::uint32_t(sizeof(Ktx2Header) + sizeof(LevelIndex));
  h.dfd_size = std::uint32_t(4 * dfd.size());
  h.kvd_offset = h.dfd_offset + h.dfd_size;
  h.kvd_size = std::uint32_t(kvd.size());
  const auto align = std::uint64_t(format.bytes);
  const std::uint64_t start = (h.kvd_offset + h.kvd_size + align - 1) / align * align,
                      size = volume.texels.size_bytes();
  const LevelIndex index{start, size, size};
  file.put(&h, sizeof h);
  file.put(&index, sizeof index);
  file.put(dfd.data(), h.dfd_size);
  file.put(kvd.data(), kvd.size());
  file.seek(std::int64_t(start));
  file.put(volume.texels.data(), size);
}

TextureFile open_ktx2(const InputFile& file) {
  const auto h = read_as<Ktx2Header>(file, 0);
  const auto* format = std::ranges::find(texel_formats, h.vk_format, &TexelFormat::vulkan);
  if (format == std::end(texel_formats))
    throw InputError(
        fmt::format("not supported: KTX2 with VkFormat {}: only RGB as bytes, floats, E5B9G9R9, BC6H or UASTC HDR 4x4 "
                    "is read",
                    h.vk_format));
  if (h.scheme != plain && h.scheme != zstandard)
    throw InputError(
        fmt::format("not supported: KTX2 with supercompression {}: only none and Zstandard are read", h.scheme));
  if (h.depth != 0 || h.layers > 1 || (h.faces != 1 && h.faces != 6))
    throw InputError(
        fmt::format("not supported: KTX2 of depth {}, {} layers and {} faces: one flat image or one cube map is read",
                    h.depth, h.layers, h.faces));
  constexpr std::uint32_t most = 0x7fffffff;
  TextureFile t{.container = "ktx2",
                .texels = format->texels,
                .width = int(std::min(h.width, most)),
                .height = int(std::min(h.height, most)),
                .levels = int(std::clamp(h.levels, 1U, most)),
                .cube = h.faces == 6};
  check_texture(t, file.size());
  KeyValues pairs;
  if (h.kvd_size > 0) pairs = parse_key_values(read_bytes(file, h.kvd_offset, h.kvd_size));
  if (const std::string& o = pairs["KTXorientation"]; !o.empty()) {
    t.bottom_up = o == "ru";
    if (o != "rd" && (o != "ru" || t.cube))
      throw InputError(
          fmt::format("not supported: KTX2 of orientation '{}': 'rd' is read, and 'ru' of flat images", o));
  }
  if (const std::string& s = pairs["KTXswizzle"]; !s.empty() && !s.starts_with("rgb"))
    throw InputError(fmt::format("not supported: KTX2 of swizzle '{}': channels are read as they are stored", s));
  t.recorded = recorded(pairs);
  require_uastc_hdr(file, h);
  t.colour = described_colour(file, h);

  std::vector<LevelIndex> index;
  for (int k = 0; k < t.levels; ++k) {
    index.push_back(read_as<LevelIndex>(file, sizeof(Ktx2Header) + std::size_t(k) * sizeof(LevelIndex)));
    const std::uint64_t wanted = (t.cube ? 6 : 1) * t.image_bytes(k);
    if (index.back().plain_size != wanted || (h.scheme == plain && index.back().size != wanted))
      throw InputError(fmt::format("damaged: level {} has {} bytes, not {}", k, index.back().plain_size, wanted));
  }
  t.bytes = [index, scheme = h.scheme](const InputFile& from, int level) {
    const LevelIndex& at = index[std::size_t(level)];
    std::vector<std::byte> bytes = read_bytes(from, at.offset, at.size);
    return scheme == plain ? bytes : decompressed(bytes, at.plain_size);
  };
  return t;
}

}  // namespace envmap
