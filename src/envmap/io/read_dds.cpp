#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>

#include "envmap/base/error.h"
#include "envmap/io/containers.h"
#include "envmap/io/dds_header.h"
#include "envmap/io/dxgi.h"
#include "envmap/io/formats.h"

namespace envmap {
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

void check_dds(const InputFile& file) {
  const auto h = read_as<Header>(file, 0);
  if (!(h.format.flags & format_four_cc)) (void)content_by_masks(h.format);
}

}  // namespace envmap
