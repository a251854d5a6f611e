// DDS of DirectX: its header, the numbers of DXGI's formats, reading, and writing.
#include "envmap/io/formats/dds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/io/formats/openimageio_module.h"
#include "envmap/io/images/bands.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/write_plan.h"

namespace envmap::dds {

// The headers of DDS files (Microsoft, "DDS_HEADER structure" and "DDS_HEADER_DXT10 structure").

namespace {

constexpr std::uint32_t four(const char (&c)[5]) {
  return std::uint32_t(c[0]) | std::uint32_t(c[1]) << 8 | std::uint32_t(c[2]) << 16 | std::uint32_t(c[3]) << 24;
}

struct Header {
  std::uint32_t magic, size, flags, height, width, pitch, depth, levels;
  std::array<std::uint32_t, 11> reserved;
  struct PixelFormat {
    std::uint32_t size, flags, four_cc, bits, red, green, blue, alpha;
  } format;
  std::uint32_t caps, caps2, caps3, caps4, reserved2;
};
static_assert(sizeof(Header) == 128);

struct Dx10 {
  std::uint32_t dxgi, dimension, misc, array_size, misc2;
};
static_assert(sizeof(Dx10) == 20);

using Bits = const std::uint32_t;
inline constexpr Bits flags_of_texture = 0x1 | 0x2 | 0x4 | 0x1000;  // Caps, height, width, pixel format.
inline constexpr Bits flag_pitch = 0x8, flag_levels = 0x20000, flag_size = 0x80000;
inline constexpr Bits format_alpha = 0x1, format_four_cc = 0x4, format_rgb = 0x40, format_luminance = 0x20000;
inline constexpr Bits caps_texture = 0x1000, caps_complex = 0x8, caps_levels = 0x400000;
inline constexpr Bits caps2_cube = 0x200, caps2_all_faces = 0xfc00, caps2_volume = 0x200000;
inline constexpr Bits dimension_2d = 3, misc_cube = 0x4, alpha_mode = 0x7, alpha_premultiplied = 2, alpha_opaque = 3;

}  // namespace
}  // namespace envmap::dds

namespace envmap {

// Formats of texels as DirectX numbers and names them.

namespace {

/// How a format of packed integers lies, and whether it is one of sRGB.
struct PackedFormat {
  std::uint32_t dxgi;
  Packing packing;
  bool srgb = false;
};

}  // namespace

// The formats of DXGI.

namespace {

// In the order of their numbers, from 0 (dxgiformat.h).
constexpr std::string_view names =
    "UNKNOWN R32G32B32A32_TYPELESS R32G32B32A32_FLOAT R32G32B32A32_UINT R32G32B32A32_SINT R32G32B32_TYPELESS "
    "R32G32B32_FLOAT R32G32B32_UINT R32G32B32_SINT R16G16B16A16_TYPELESS R16G16B16A16_FLOAT "
    "R16G16B16A16_UNORM R16G16B16A16_UINT R16G16B16A16_SNORM R16G16B16A16_SINT R32G32_TYPELESS R32G32_FLOAT "
    "R32G32_UINT R32G32_SINT R32G8X24_TYPELESS D32_FLOAT_S8X24_UINT R32_FLOAT_X8X24_TYPELESS "
    "X32_TYPELESS_G8X24_UINT R10G10B10A2_TYPELESS R10G10B10A2_UNORM R10G10B10A2_UINT R11G11B10_FLOAT "
    "R8G8B8A8_TYPELESS R8G8B8A8_UNORM R8G8B8A8_UNORM_SRGB R8G8B8A8_UINT R8G8B8A8_SNORM R8G8B8A8_SINT "
    "R16G16_TYPELESS R16G16_FLOAT R16G16_UNORM R16G16_UINT R16G16_SNORM R16G16_SINT R32_TYPELESS D32_FLOAT "
    "R32_FLOAT R32_UINT R32_SINT R24G8_TYPELESS D24_UNORM_S8_UINT R24_UNORM_X8_TYPELESS X24_TYPELESS_G8_UINT "
    "R8G8_TYPELESS R8G8_UNORM R8G8_UINT R8G8_SNORM R8G8_SINT R16_TYPELESS R16_FLOAT D16_UNORM R16_UNORM "
    "R16_UINT R16_SNORM R16_SINT R8_TYPELESS R8_UNORM R8_UINT R8_SNORM R8_SINT A8_UNORM R1_UNORM "
    "R9G9B9E5_SHAREDEXP R8G8_B8G8_UNORM G8R8_G8B8_UNORM BC1_TYPELESS BC1_UNORM BC1_UNORM_SRGB BC2_TYPELESS "
    "BC2_UNORM BC2_UNORM_SRGB BC3_TYPELESS BC3_UNORM BC3_UNORM_SRGB BC4_TYPELESS BC4_UNORM BC4_SNORM "
    "BC5_TYPELESS BC5_UNORM BC5_SNORM B5G6R5_UNORM B5G5R5A1_UNORM B8G8R8A8_UNORM B8G8R8X8_UNORM "
    "R10G10B10_XR_BIAS_A2_UNORM B8G8R8A8_TYPELESS B8G8R8A8_UNORM_SRGB B8G8R8X8_TYPELESS B8G8R8X8_UNORM_SRGB "
    "BC6H_TYPELESS BC6H_UF16 BC6H_SF16 BC7_TYPELESS BC7_UNORM BC7_UNORM_SRGB AYUV Y410 Y416 NV12 P010 P016 "
    "420_OPAQUE YUY2 Y210 Y216 NV11 AI44 IA44 P8 A8P8 B4G4R4A4_UNORM";

constexpr Packing rgba8{4, 0xff, 0xff00, 0xff0000, 0xff000000}, bgra8{4, 0xff0000, 0xff00, 0xff, 0xff000000},
    bgrx8{4, 0xff0000, 0xff00, 0xff};
constexpr PackedFormat packed_formats[] = {
    {11, {8, 0xffff, 0xffff0000, 0xffff00000000, 0xffff000000000000}},
    {24, {4, 0x3ff, 0xffc00, 0x3ff00000, 0xc0000000}},
    {28, rgba8},
    {29, rgba8, true},
    {56, {2, 0xffff}},
    {61, {1, 0xff}},
    {85, {2, 0xf800, 0x7e0, 0x1f}},
    {86, {2, 0x7c00, 0x3e0, 0x1f, 0x8000}},
    {87, bgra8},
    {88, bgrx8},
    {91, bgra8, true},
    {93, bgrx8, true},
    {115, {2, 0xf00, 0xf0, 0xf, 0xf000}},
};

/// "R8G8_UNORM" of 49, or "DXGI_FORMAT 200" where the number has no name.
std::string dxgi_name(std::uint32_t dxgi) {
  const std::vector<std::string> all = split(names, ' ');
  return dxgi < all.size() ? all[dxgi] : fmt::format("DXGI_FORMAT {}", dxgi);
}

/// Nothing for other formats.
std::optional<PackedFormat> packed_format(std::uint32_t dxgi) {
  const auto* const found = std::ranges::find(packed_formats, dxgi, &PackedFormat::dxgi);
  return found == std::end(packed_formats) ? std::nullopt : std::optional(*found);
}

}  // namespace

// Reading.

namespace {

using namespace dds;

// What the texels of a file are.
struct Content {
  Texels texels = Texels::packed;
  Packing packing = {};
  std::uint32_t blocks = 0;  // Their four characters where they are blocks that OpenImageIO decodes.
  bool by_integers = false;  // No header of integers says whether they are sRGB encoded: they are.
  std::string linear = {};   // The name of a format of bytes that are linear, where there is one of sRGB, too.
};

// Blocks of bytes, by the number of those with and without sRGB in DirectX, and by the name that they had before.
struct BlockFormat {
  std::uint32_t dxgi, srgb, four_cc, older = 0;
};
constexpr BlockFormat block_formats[] = {
    {71, 72, four("DXT1")},
    {74, 75, four("DXT3"), four("DXT2")},
    {77, 78, four("DXT5"), four("DXT4")},
    {80, 0, four("ATI1"), four("BC4U")},
    {98, 99, four("DX10")},
};

// Numbers of Direct3D 9's formats that stand where four characters do (d3d9types.h).
struct NumberedFormat {
  std::uint32_t number;
  Texels texels;
};
constexpr NumberedFormat numbered_formats[] = {{111, Texels::r16f},
                                               {113, Texels::rgba16f},
                                               {114, Texels::r32f},
                                               {116, Texels::rgba32f}};
constexpr std::uint32_t d3d9_rgba16 = 36, dxgi_rgba16 = 11;

[[noreturn]] void refuse(const std::string& what) {
  throw InputError(fmt::format(
      "not supported: DDS of {}: make R16G16B16A16_FLOAT or R8G8B8A8_UNORM_SRGB of it, such as with 'texconv -f'",
      what));
}

std::string four_cc_name(std::uint32_t code) {
  std::string name;
  for (int k = 0; k < 4; ++k) name += static_cast<char>(code >> 8 * k & 0xff);
  const bool plain = std::ranges::all_of(name, [](unsigned char c) { return std::isprint(c) != 0; });
  return plain ? fmt::format("FourCC '{}'", name) : fmt::format("FourCC {}", code);
}

bool is_run_of_bits(std::uint32_t mask) {
  return mask != 0 && std::has_single_bit((std::uint64_t{mask} >> std::countr_zero(mask)) + 1);
}

// Integers between the masks of the header.
Content content_by_masks(const Header::PixelFormat& f) {
  const bool grey = f.flags & format_luminance, alpha = f.flags & format_alpha;
  if (!grey && !(f.flags & format_rgb)) refuse(fmt::format("pixel format flags 0x{:x}, neither RGB nor grey", f.flags));
  const Packing p{int(f.bits / 8), f.red, grey ? 0 : f.green, grey ? 0 : f.blue, alpha ? f.alpha : 0};
  const std::uint32_t there = f.bits >= 32 ? ~0U : (1U << f.bits) - 1;
  const auto sound = [&](std::uint64_t mask) { return is_run_of_bits(std::uint32_t(mask)) && (mask & ~there) == 0; };
  if (f.bits == 0 || f.bits > 32 || f.bits % 8 != 0 || !sound(p.red) ||
      (!grey && (!sound(p.green) || !sound(p.blue))) || (alpha && !sound(p.alpha)))
    throw InputError(
        fmt::format("damaged: DDS of {} bits whose channels are the bits 0x{:x}, 0x{:x}, 0x{:x} and 0x{:x}", f.bits,
                    f.red, f.green, f.blue, f.alpha));
  return {.packing = p, .by_integers = true};
}

Content content_by_four_cc(std::uint32_t code) {
  if (code == d3d9_rgba16) return {.packing = packed_format(dxgi_rgba16)->packing, .by_integers = true};
  for (const NumberedFormat& n : numbered_formats)
    if (n.number == code) return {.texels = n.texels};
  for (const BlockFormat& b : block_formats)
    if (b.four_cc == code || b.older == code)
      return {.texels = Texels::rgba8, .blocks = b.four_cc, .by_integers = true};
  refuse(four_cc_name(code));
}

Content content_by_dxgi(std::uint32_t dxgi) {
  const auto* known = std::ranges::find(texel_formats, dxgi, &TexelFormat::dxgi);
  if (dxgi != 0 && known != std::end(texel_formats)) return {.texels = known->texels};
  const auto packed = packed_format(dxgi);
  const std::string name = dxgi_name(dxgi);
  if (packed) {
    const bool has_twin = std::popcount(packed->packing.red) == 8 && packed->packing.green != 0;
    return {.texels = packed->srgb ? Texels::packed_srgb : Texels::packed,
            .packing = packed->packing,
            .linear = has_twin && !packed->srgb ? name : ""};
  }
  for (const BlockFormat& b : block_formats)
    if (dxgi != 0 && (b.dxgi == dxgi || b.srgb == dxgi))
      return {.texels = b.srgb == dxgi ? Texels::rgba8_srgb : Texels::rgba8,
              .blocks = b.four_cc,
              .linear = b.dxgi == dxgi ? name : ""};
  refuse(name);
}

// Where the images of a file lie: face after face, each with all its levels.
struct Images {
  TextureFile texture;
  std::uint32_t blocks;
  std::uint64_t start = 0, stride = 0;  // Bytes from row to row where it is not that of the texels; 0: it is.

  [[nodiscard]] std::uint64_t tight(int level) const {
    constexpr std::uint64_t side = 4;
    const std::uint64_t across = (std::uint64_t(texture.level_width(level)) + side - 1) / side;
    if (blocks != 0) return across * (blocks == four("DXT1") || blocks == four("ATI1") ? 8 : 16);
    return texture.format().row_bytes(texture.level_width(level));
  }
  [[nodiscard]] std::uint64_t rows(int level) const {
    const auto height = std::uint64_t(texture.level_height(level));
    return blocks != 0 ? (height + 3) / 4 : texture.format().blocks(int(height));
  }
  [[nodiscard]] std::uint64_t row(int level) const {
    const std::uint64_t words = (tight(level) + 3) / 4 * 4;
    return stride == 0 ? tight(level) : texture.levels == 1 ? stride : words;
  }
  [[nodiscard]] std::uint64_t before(int level) const {
    std::uint64_t bytes = 0;
    for (int k = 0; k < level; ++k) bytes += row(k) * rows(k);
    return bytes;
  }
  [[nodiscard]] std::uint64_t all() const { return before(texture.levels) * (texture.cube ? 6 : 1); }
};

// An image of blocks as RGBA, each channel a byte: a file of this image alone goes through OpenImageIO.
std::vector<std::byte> decoded(std::uint32_t blocks, int width, int height, std::span<const std::byte> image) {
  const auto whole = [](int side) { return std::uint32_t(side + 3) / 4 * 4; };
  Header h{};
  h.magic = four("DDS ");
  h.size = sizeof(Header) - 4;
  h.flags = flags_of_texture | flag_size;
  h.width = whole(width), h.height = whole(height);
  h.pitch = std::uint32_t(image.size());
  h.levels = 1;
  h.format = {.size = sizeof(Header::PixelFormat), .flags = format_four_cc, .four_cc = blocks};
  h.caps = caps_texture;
  const Dx10 bc7{98, dimension_2d, 0, 1, 0};
  std::vector<char> file(sizeof h);
  std::memcpy(file.data(), &h, sizeof h);
  if (blocks == four("DX10"))
    file.insert(file.end(), reinterpret_cast<const char*>(&bc7), reinterpret_cast<const char*>(&bc7 + 1));
  file.insert(file.end(), reinterpret_cast<const char*>(image.data()),
              reinterpret_cast<const char*>(image.data() + image.size()));

  const ImageReader reader = formats().open("dds", "blocks.dds", file, true, false);
  const std::size_t channels = reader.facts.channels.size(), across = h.width;
  if (reader.facts.width != int(h.width) || reader.facts.height != int(h.height) || (channels != 1 && channels != 4))
    throw InputError("not supported: blocks that this OpenImageIO does not decode");
  std::vector<float> values(across * h.height * channels);
  reader.read(0, 0, int(h.height), 0, int(channels), values);
  std::vector<std::byte> bytes;
  bytes.reserve(std::size_t(width) * std::size_t(height) * 4);
  for (std::size_t y = 0; y < std::size_t(height); ++y)
    for (std::size_t x = 0; x < std::size_t(width); ++x)
      for (std::size_t c = 0; c < 4; ++c) {
        const float v = channels == 4 ? values[(y * across + x) * 4 + c] : c < 3 ? values[y * across + x] : 1;
        bytes.push_back(static_cast<std::byte>(std::lround(255 * v)));
      }
  return bytes;
}

std::vector<std::byte> bytes_of(const InputFile& file, const Images& images, int level) {
  const TextureFile& t = images.texture;
  const std::uint64_t rows = images.rows(level), row = images.row(level), tight = images.tight(level);
  std::vector<std::byte> bytes;
  for (std::uint64_t face = 0; face < (t.cube ? 6 : 1); ++face) {
    const std::uint64_t at = images.start + face * images.before(t.levels) + images.before(level);
    std::vector<std::byte> image = read_bytes(file, at, rows * row);
    for (std::uint64_t y = 1; y < rows && row != tight; ++y)
      std::copy_n(image.begin() + std::ptrdiff_t(y * row), tight, image.begin() + std::ptrdiff_t(y * tight));
    image.resize(rows * tight);
    if (images.blocks != 0) image = decoded(images.blocks, t.level_width(level), t.level_height(level), image);
    bytes.insert(bytes.end(), image.begin(), image.end());
  }
  return bytes;
}

// Old programs pad rows, to words for one. The size of the file tells.
void find_rows(const Header& h, std::uint64_t file_size, Images& images) {
  const std::uint64_t there = file_size - std::min(file_size, images.start);
  if (const std::uint64_t tight = images.tight(0); there != images.all() && h.pitch > tight && images.blocks == 0) {
    images.stride = h.pitch;
    const bool words = images.texture.levels == 1 || h.pitch == (tight + 3) / 4 * 4;
    if (!words || images.all() != there) images.stride = 0;
  }
  if (images.all() > there)
    throw InputError(
        fmt::format("truncated or damaged: its texels take {} bytes, and {} follow its header", images.all(), there));
  if (images.all() < there)
    images.texture.notes.push_back(fmt::format("{} bytes after its last texel are not read", there - images.all()));
}

}  // namespace

TextureFile open_dds(const InputFile& file) {
  const auto h = read_as<Header>(file, 0);
  const bool has_dx10 = (h.format.flags & format_four_cc) && h.format.four_cc == four("DX10");
  const Dx10 dx10 = has_dx10 ? read_as<Dx10>(file, sizeof h) : Dx10{0, dimension_2d, 0, 1, 0};
  const Content content = has_dx10                          ? content_by_dxgi(dx10.dxgi)
                          : h.format.flags & format_four_cc ? content_by_four_cc(h.format.four_cc)
                                                            : content_by_masks(h.format);
  const bool old_cube = h.caps2 & caps2_cube, cube = old_cube || (has_dx10 && dx10.misc & misc_cube);
  if (h.caps2 & caps2_volume || dx10.dimension != dimension_2d)
    throw InputError("not supported: DDS of a volume or a line: one flat image or one cube map is read");
  if (dx10.array_size != 1)
    throw InputError(
        fmt::format("not supported: DDS with an array of {}: one flat image or one cube map is read", dx10.array_size));
  if (old_cube && (h.caps2 & caps2_all_faces) != caps2_all_faces)
    throw InputError("not supported: DDS of a cube with some faces only: all six are needed");
  constexpr std::uint32_t most = 0x7fffffff;
  Images images{.texture = {.container = "dds",
                            .texels = content.texels,
                            .packing = content.packing,
                            .width = int(std::min(h.width, most)),
                            .height = int(std::min(h.height, most)),
                            .levels = int(std::clamp(h.levels, 1U, most)),
                            .cube = cube,
                            .by_integers = content.by_integers},
                .blocks = content.blocks,
                .start = sizeof h + (has_dx10 ? sizeof dx10 : 0)};
  check_texture(images.texture, file.size());
  find_rows(h, file.size(), images);
  auto& notes = images.texture.notes;
  auto& claims = images.texture.claims;
  if (has_dx10) claims.push_back({.name = "dxgiFormat", .value = dxgi_name(dx10.dxgi), .of_colour = true});
  if (!content.linear.empty())
    notes.push_back(fmt::format("its texels are linear, as {} says: that of sRGB has another name", content.linear));
  if ((has_dx10 && (dx10.misc2 & alpha_mode) == alpha_premultiplied) || h.format.four_cc == four("DXT2") ||
      h.format.four_cc == four("DXT4"))
    claims.push_back({.name = "alpha mode", .value = "premultiplied"});
  TextureFile texture = images.texture;
  texture.bytes = [images](const InputFile& from, int level) { return bytes_of(from, images, level); };
  return texture;
}

ImageReader open_dds_image(InputFile& file, const std::string& name) {
  const auto h = read_as<Header>(file, 0);
  // OpenImageIO 2.4 goes round and round where a channel has no bits.
  if (!(h.format.flags & format_four_cc)) (void)content_by_masks(h.format);
  file.hold();
  try {
    return formats().open("dds", name, file.bytes(), true, false);
  } catch (const InputError& e) {
    const std::string why = e.what();
    if (why.find("nsupported") == why.npos || !(h.format.flags & format_four_cc)) throw;
    const bool has_dx10 = h.format.four_cc == four("DX10");
    throw InputError(
        fmt::format("not supported: an image on a surface in DDS of {}: {}",
                    has_dx10 ? dxgi_name(read_as<Dx10>(file, sizeof h).dxgi) : four_cc_name(h.format.four_cc), why));
  }
}

// Writing.

void write_dds(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  using namespace dds;
  const TexelFormat& format = format_of(plan.texels);
  const bool chain = levels.size() > 1, cube = plan.cube;
  Header h{};
  h.magic = four("DDS ");
  h.size = sizeof(Header) - 4;
  h.flags = flags_of_texture | (format.side > 1 ? flag_size : flag_pitch) | (chain ? flag_levels : 0);
  h.width = std::uint32_t(levels[0].width());
  h.height = cube ? h.width : std::uint32_t(levels[0].height());
  // The field `pitch` holds the size of the first image of blocks, and the size of a row of texels.
  h.pitch = std::uint32_t(format.side > 1 ? format.image_bytes(levels[0].width(), int(h.height))
                                          : format.row_bytes(levels[0].width()));
  h.levels = std::uint32_t(levels.size());
  h.format = {.size = sizeof(Header::PixelFormat), .flags = format_four_cc, .four_cc = four("DX10")};
  h.caps = caps_texture | (chain || cube ? caps_complex : 0) | (chain ? caps_levels : 0);
  h.caps2 = cube ? caps2_cube | caps2_all_faces : 0;
  const Dx10 dx10{format.dxgi, dimension_2d, cube ? misc_cube : 0, 1, alpha_opaque};
  file.put(&h, sizeof h);
  file.put(&dx10, sizeof dx10);

  std::vector<Atlas> images;
  for (std::size_t face = 0; face < (cube ? 6 : 1); ++face)
    for (const Atlas& level : levels) images.push_back(images_of(level, cube)[face]);
  PartsOfProgress shares(progress, levels);
  encode_images(format, images, shares, [&](std::span<const std::byte> rows) { file.put(rows.data(), rows.size()); });
}

}  // namespace envmap
