#include "envmap/io/dxgi.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include "envmap/base/split.h"

namespace envmap {
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

}  // namespace

std::string dxgi_name(std::uint32_t dxgi) {
  const std::vector<std::string> all = split(names, ' ');
  return dxgi < all.size() ? all[dxgi] : fmt::format("DXGI_FORMAT {}", dxgi);
}

std::optional<PackedFormat> packed_format(std::uint32_t dxgi) {
  const auto* const found = std::ranges::find(packed_formats, dxgi, &PackedFormat::dxgi);
  return found == std::end(packed_formats) ? std::nullopt : std::optional(*found);
}

}  // namespace envmap
