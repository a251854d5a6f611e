#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "envmap/base/error.h"
#include "envmap/io/bands.h"
#include "envmap/io/containers.h"
#include "envmap/io/write_plan.h"

namespace envmap {
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
constexpr Bits flags_of_texture = 0x1 | 0x2 | 0x4 | 0x1000;  // Caps, height, width, pixel format.
constexpr Bits flag_pitch = 0x8, flag_levels = 0x20000, flag_size = 0x80000;
constexpr Bits format_alpha = 0x1, format_alpha_only = 0x2, format_four_cc = 0x4, format_luminance = 0x20000;
constexpr Bits caps_texture = 0x1000, caps_complex = 0x8, caps_levels = 0x400000;
constexpr Bits caps2_cube = 0x200, caps2_all_faces = 0xfc00, caps2_volume = 0x200000;
constexpr Bits dimension_2d = 3, misc_cube = 0x4, alpha_opaque = 3;

// Direct3D 9 wrote its formats' numbers where four characters stand: A16B16G16R16F and A32B32G32R32F.
constexpr std::uint32_t d3d9_half = 113, d3d9_float = 116;

// Of integer texels: OpenImageIO 2.4 goes round and round where a channel has no bits.
void check_masks(const Header& h) {
  const auto& f = h.format;
  const bool alpha_only = f.flags & format_alpha_only, grey = f.flags & format_luminance;
  const std::uint32_t there = f.bits >= 32 ? ~0U : (1U << f.bits) - 1;
  const auto sound = [&](std::uint32_t mask) { return mask != 0 && (mask & ~there) == 0; };
  if (f.bits == 0 || f.bits > 32 || f.bits % 8 != 0 || (!alpha_only && !sound(f.red)) ||
      (!alpha_only && !grey && (!sound(f.green) || !sound(f.blue))) ||
      ((alpha_only || f.flags & format_alpha) && !sound(f.alpha)))
    throw InputError("damaged: DDS with channels that have no bits");
}

}  // namespace

void write_dds(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  const TexelFormat& format = format_of(plan.texels);
  const bool chain = levels.size() > 1, cube = plan.cube;
  Header h{};
  h.magic = four("DDS ");
  h.size = sizeof(Header) - 4;
  h.flags = flags_of_texture | (format.side > 1 ? flag_size : flag_pitch) | (chain ? flag_levels : 0);
  h.width = std::uint32_t(levels[0].width());
  h.height = cube ? h.width : std::uint32_t(levels[0].height());
  // Of blocks the size of the first image, else that of a row.
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
  Shares shares(progress, levels);
  encode_images(format, images, shares, [&](std::span<const std::byte> rows) { file.put(rows.data(), rows.size()); });
}

std::optional<TextureFile> open_dds(const InputFile& file) {
  const auto h = read_as<Header>(file, 0);
  if (!(h.format.flags & format_four_cc)) {
    check_masks(h);
    return std::nullopt;
  }
  std::uint64_t start = sizeof(Header);
  const TexelFormat* format = nullptr;
  bool cube = h.caps2 & caps2_cube;
  std::uint32_t images = 1;
  if (h.format.four_cc == four("DX10")) {
    const auto dx10 = read_as<Dx10>(file, start);
    start += sizeof(Dx10);
    if (dx10.dxgi != 0) format = std::ranges::find(texel_formats, dx10.dxgi, &TexelFormat::dxgi);
    if (dx10.dimension != dimension_2d) images = 0;
    cube = dx10.misc & misc_cube;
    images *= dx10.array_size;
  } else if (h.format.four_cc == d3d9_half || h.format.four_cc == d3d9_float) {
    format = &format_of(h.format.four_cc == d3d9_half ? Texels::rgba16f : Texels::rgba32f);
    if (cube && (h.caps2 & caps2_all_faces) != caps2_all_faces) images = 0;
  }
  if (format == nullptr || format == std::end(texel_formats)) return std::nullopt;
  if (images != 1 || h.caps2 & caps2_volume)
    throw InputError("DDS with an array, slices or some faces only: one flat image or one cube map is read");
  constexpr std::uint32_t most = 0x7fffffff;
  TextureFile t{.container = "dds",
                .texels = format->texels,
                .width = int(std::min(h.width, most)),
                .height = int(std::min(h.height, most)),
                .levels = int(std::clamp(h.levels, 1U, most)),
                .cube = cube};
  check_texture(t, file.size());
  t.bytes = [start, t](const InputFile& from, int level) {
    std::uint64_t before = 0, chain = 0;
    for (int k = 0; k < t.levels; ++k) {
      if (k < level) before += t.image_bytes(k);
      chain += t.image_bytes(k);
    }
    std::vector<std::byte> bytes;
    for (std::uint64_t face = 0; face < (t.cube ? 6 : 1); ++face) {
      const auto image = read_bytes(from, start + face * chain + before, t.image_bytes(level));
      bytes.insert(bytes.end(), image.begin(), image.end());
    }
    return bytes;
  };
  return t;
}

}  // namespace envmap
