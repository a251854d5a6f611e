#include "envmap/io/file_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <vector>

#include "envmap/io/babylon_env.h"
#include "envmap/io/gltf_light.h"
#include "envmap/io/ktx1.h"
#include "envmap/io/ktx2.h"
#include "envmap/io/radiance.h"

namespace envmap {
namespace {

using Extension = std::string_view;
constexpr Extension exr[] = {"exr"}, hdr[] = {"hdr"}, pfm[] = {"pfm"}, ktx2[] = {"ktx2"}, ktx1[] = {"ktx"},
                    dds[] = {"dds"}, env[] = {"env"}, glb[] = {"glb"}, tiff[] = {"tif", "tiff"}, png[] = {"png"},
                    ppm[] = {"ppm"}, jpeg[] = {"jpg", "jpeg"}, targa[] = {"tga"}, bmp[] = {"bmp"}, webp[] = {"webp"};
constexpr Depth linear[] = {Depth::half, Depth::single}, floats[] = {Depth::single},
                texture[] = {Depth::half, Depth::single, Depth::rgb9e5, Depth::bc6h}, bytes[] = {Depth::uint8},
                rgbd[] = {Depth::rgbd}, integers[] = {Depth::uint8, Depth::uint16},
                all_of_tiff[] = {Depth::uint8, Depth::uint16, Depth::single};

constexpr double any_float = std::numeric_limits<float>::max();

using Head = std::string_view;
bool is_pnm(Head h, std::string_view kinds) { return h.size() > 1 && h[0] == 'P' && kinds.find(h[1]) != kinds.npos; }

// Columns: file_format.h. In the order in which people are told of them.
constexpr FileFormat table[] = {
    {"openexr", "EXR", exr, linear, [](Head h) { return h.starts_with("\x76\x2f\x31\x01"); }, true, any_float, true},
    {"hdr", "HDR", hdr, floats, [](Head h) { return h.starts_with("#?"); }, false, largest_radiance},
    {"pnm", "PFM", pfm, floats, [](Head h) { return is_pnm(h, "Ff"); }, false},
    {"ktx2", "KTX2", ktx2, texture, [](Head h) { return h.starts_with(ktx2_mark); }, true, any_float, true, true},
    {"ktx", "KTX", ktx1, texture, [](Head h) { return h.starts_with(ktx1_mark); }, true, any_float, true, true},
    {"dds", "DDS", dds, texture, [](Head h) { return h.starts_with("DDS "); }, false, any_float, true, true},
    {"env", "Babylon.js .env", env, rgbd, [](Head h) { return h.starts_with(env_mark); }, true, any_float, true, true,
     true},
    {"glb", "glTF light", glb, rgbd, is_glb, true, any_float, true, true, true, true},
    {"tiff", "TIFF", tiff, all_of_tiff, [](Head h) { return h.starts_with("II") || h.starts_with("MM"); }, true},
    {"png", "PNG", png, integers, [](Head h) { return h.starts_with("\x89PNG"); }, true},
    {"pnm", "PNM", ppm, bytes, [](Head h) { return is_pnm(h, "123456"); }, false},
    {"jpeg", "JPEG", jpeg, bytes, [](Head h) { return h.starts_with("\xff\xd8"); }, true},
    {"targa", "TGA", targa, bytes, nullptr, true},
    {"bmp", "BMP", bmp, bytes, [](Head h) { return h.starts_with("BM"); }, false},
    {"webp", "WebP", webp, bytes, [](Head h) { return h.starts_with("RIFF") && h.find("WEBP") == 8; }, false},
    {"jpeg2000", "JPEG 2000", {}, {}, [](Head h) { return h.find("jP  ") == 4 || h.starts_with("\xff\x4f\xff\x51"); },
     false},
    {"gif", "GIF", {}, {}, [](Head h) { return h.starts_with("GIF8"); }, false},
    {"psd", "PSD", {}, {}, [](Head h) { return h.starts_with("8BPS"); }, false},
    {"sgi", "SGI", {}, {}, [](Head h) { return h.starts_with("\x01\xda"); }, false},
};

// "a, b or c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k)
    text += (k == 0 ? "" : k + 1 < words.size() ? ", " : " or ") + words[k];
  return text;
}

}  // namespace

std::span<const FileFormat> file_formats() { return table; }

const FileFormat* format_with_extension(std::string_view extension) {
  const auto found = std::ranges::find_if(
      table, [&](const FileFormat& f) { return std::ranges::find(f.extensions, extension) != f.extensions.end(); });
  return found == std::end(table) ? nullptr : found;
}

const FileFormat* format_of(std::string_view head, std::string_view path) {
  for (const FileFormat& f : table)
    if (f.is_head && f.is_head(head)) return &f;
  const FileFormat* named = format_with_extension(extension_of(path));
  return named && !named->is_head ? named : nullptr;
}

std::string extension_of(std::string_view path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string readable_formats() {
  std::vector<std::string> titles;
  for (const FileFormat& f : table) titles.emplace_back(f.title);
  return listed(titles);
}

std::string writable_extensions(Projection projection, bool levels) {
  std::vector<std::string> names;
  for (const FileFormat& f : table) {
    const bool fits = f.levels || !levels, whole = !f.cubes_alone || (projection == Projection::cube && levels);
    if (f.is_written() && !f.irradiance && fits && whole) names.push_back(fmt::format(".{}", f.extensions.front()));
  }
  return listed(names);
}

}  // namespace envmap
