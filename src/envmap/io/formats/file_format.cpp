#include "envmap/io/formats/file_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <vector>

#include "envmap/base/words.h"
#include "envmap/io/claims/heif_colour.h"
#include "envmap/io/claims/module_colour.h"
#include "envmap/io/formats/babylon_env.h"
#include "envmap/io/formats/dds.h"
#include "envmap/io/formats/gltf_light.h"
#include "envmap/io/formats/jpeg.h"
#include "envmap/io/formats/ktx.h"
#include "envmap/io/formats/pfm.h"
#include "envmap/io/formats/png.h"
#include "envmap/io/formats/radiance.h"
#include "envmap/io/formats/tiff.h"
#include "envmap/io/images/open_image.h"
#include "envmap/io/write_plan.h"

namespace envmap {
namespace {

using Extension = std::string_view;
constexpr Extension exr[] = {"exr"}, hdr[] = {"hdr"}, pfm[] = {"pfm"}, ktx2[] = {"ktx2"}, ktx1[] = {"ktx"},
                    dds[] = {"dds"}, env[] = {"env"}, glb[] = {"glb"}, tiff[] = {"tif", "tiff"}, png[] = {"png"},
                    ppm[] = {"ppm"}, jpeg[] = {"jpg", "jpeg"}, targa[] = {"tga"}, bmp[] = {"bmp"}, webp[] = {"webp"};
constexpr Depth linear[] = {Depth::half, Depth::single}, floats[] = {Depth::single},
                texture[] = {Depth::half, Depth::single, Depth::rgb9e5, Depth::bc6h},
                texture_of_2020[] = {Depth::half, Depth::single, Depth::rgb9e5, Depth::bc6h, Depth::uastc_hdr},
                bytes[] = {Depth::uint8}, rgbd[] = {Depth::rgbd}, integers[] = {Depth::uint8, Depth::uint16},
                all_of_tiff[] = {Depth::uint8, Depth::uint16, Depth::single};

using Head = std::string_view;
bool is_pnm(Head h, std::string_view kinds) { return h.size() > 1 && h[0] == 'P' && kinds.find(h[1]) != kinds.npos; }

// What of a texel's channels a texture without alpha holds; blocks have their part of one. Zstandard's may be any.
double texture_bytes(Depth depth, const WriteOptions& o) {
  if (o.zstd) return 0;
  const TexelFormat& format = format_of(texels_of(depth));
  return double(format.bytes) * std::min(3, format.channels) / (format.channels * format.side * format.side);
}

// ZIP makes data 1032 times smaller at most (zlib's technical details).
double openexr_bytes(Depth depth, const WriteOptions& o) {
  const bool zip = o.compression.empty() || o.compression.starts_with("zip");
  return (depth == Depth::half ? 6 : 12) * (o.compression == "none" ? 1 : zip ? 1.0 / 1032 : 0);
}

constexpr FileFormat openexr{
    .name = "openexr",
    .title = "EXR",
    .extensions = exr,
    .depths = linear,
    .is_head = [](Head h) { return h.starts_with("\x76\x2f\x31\x01"); },
    .frame = true,
    .levels = true,
    .abilities = FileFormat::compression | FileFormat::envmap_mark | FileFormat::row_range | FileFormat::picture |
                 FileFormat::table | FileFormat::encoded_values | FileFormat::parts | FileFormat::window,
    .open = [](Image& i, const ImageChoice& choice) { i.reader = open_openexr(*i.file, choice); },
    .create = create_openexr,
    .least_bytes = openexr_bytes,
};
constexpr FileFormat radiance{
    .name = "hdr",
    .title = "HDR",
    .extensions = hdr,
    .depths = floats,
    .is_head = [](Head h) { return h.starts_with("#?"); },
    .largest = largest_radiance,
    .abilities = FileFormat::picture | FileFormat::table,
    .open = [](Image& i, const ImageChoice&) { i.reader = open_radiance(*i.file); },
    .create = create_radiance,
    .round = round_to_radiance,
    .least_bytes = [](Depth, const WriteOptions&) { return 4 * 2.0 / 127; },  // Runs of 127 bytes take 2.
};
constexpr FileFormat float_map{
    .name = "pnm",
    .title = "PFM",
    .extensions = pfm,
    .depths = floats,
    .is_head = [](Head h) { return is_pnm(h, "Ff"); },
    .open = [](Image& i, const ImageChoice&) { i.reader = open_pfm(*i.file); },
    .write = write_pfm,
    .least_bytes = [](Depth, const WriteOptions&) { return 12.0; },
};
constexpr FileFormat ktx_of_2020{
    .name = "ktx2",
    .title = "KTX2",
    .extensions = ktx2,
    .depths = texture_of_2020,
    .is_head = [](Head h) { return h.starts_with(ktx2_mark); },
    .frame = true,
    .levels = true,
    .texture = true,
    .abilities = FileFormat::zstd | FileFormat::encoded_values,
    .open = [](Image& i, const ImageChoice&) { i.texture = open_ktx2(*i.file); },
    .write = write_ktx2,
    .names = [](const Primaries& p) { return khr_colour(p, Curve::linear).has_value(); },
    .least_bytes = texture_bytes,
};
constexpr FileFormat ktx_of_2010{
    .name = "ktx",
    .title = "KTX",
    .extensions = ktx1,
    .depths = texture,
    .is_head = [](Head h) { return h.starts_with(ktx1_mark); },
    .frame = true,
    .levels = true,
    .texture = true,
    .open = [](Image& i, const ImageChoice&) { i.texture = open_ktx1(*i.file); },
    .write = write_ktx1,
    .least_bytes = texture_bytes,
};
constexpr FileFormat directx{
    .name = "dds",
    .title = "DDS",
    .extensions = dds,
    .depths = texture,
    .is_head = [](Head h) { return h.starts_with("DDS "); },
    .levels = true,
    .texture = true,
    .open =
        [](Image& i, const ImageChoice&) {
          if (i.for_texture)
            i.reader = open_dds_image(*i.file, i.name);
          else
            i.texture = open_dds(*i.file);
        },
    .write = write_dds,
    .least_bytes = texture_bytes,
};
constexpr FileFormat babylon{
    .name = "env",
    .title = "Babylon.js .env",
    .extensions = env,
    .depths = rgbd,
    .is_head = [](Head h) { return h.starts_with(env_mark); },
    .frame = true,
    .levels = true,
    .texture = true,
    .cubes_alone = true,
    .open = [](Image& i, const ImageChoice&) { i.texture = open_env(*i.file); },
    .write = write_env,
};
constexpr FileFormat gltf_light{
    .name = "glb",
    .title = "glTF light",
    .extensions = glb,
    .depths = rgbd,
    .is_head = is_gltf,
    .frame = true,
    .levels = true,
    .texture = true,
    .cubes_alone = true,
    .irradiance = true,
    .open = [](Image& i, const ImageChoice&) { i.texture = open_gltf_light(*i.file, i.name); },
    .write = write_gltf_light,
};
constexpr FileFormat portable_network{
    .name = "png",
    .title = "PNG",
    .extensions = png,
    .depths = integers,
    .is_head = [](Head h) { return h.starts_with("\x89PNG"); },
    .frame = true,
    .abilities = FileFormat::picture | FileFormat::encoded_values,
    .open = [](Image& i, const ImageChoice&) { i.reader = open_png(*i.file, i.for_texture, &i.found); },
    .create = create_png,
};

constexpr FileFormat tagged_images{
    .name = "tiff",
    .title = "TIFF",
    .extensions = tiff,
    .depths = all_of_tiff,
    .is_head = [](Head h) { return h.starts_with("II") || h.starts_with("MM"); },
    .frame = true,
    .abilities = FileFormat::table | FileFormat::window | FileFormat::encoded_values,
    .open = [](Image& i, const ImageChoice&) { i.reader = open_tiff(*i.file, &i.found); },
};
constexpr FileFormat photographs{
    .name = "jpeg",
    .title = "JPEG",
    .extensions = jpeg,
    .depths = bytes,
    .is_head = [](Head h) { return h.starts_with("\xff\xd8"); },
    .frame = true,
    .abilities = FileFormat::picture | FileFormat::encoded_values | FileFormat::gain_map,
    .open = [](Image& i, const ImageChoice& choice) { i.reader = open_jpeg(*i.file, choice.headroom, i.for_texture); },
};

// One that OpenImageIO reads and writes.
constexpr FileFormat other(std::string_view name, std::string_view title, std::span<const Extension> extensions,
                           std::span<const Depth> depths, bool (*is_head)(Head), bool frame = false,
                           void (*open)(Image& image, const ImageChoice& choice) = nullptr) {
  return {.name = name,
          .title = title,
          .extensions = extensions,
          .depths = depths,
          .is_head = is_head,
          .frame = frame,
          .abilities = FileFormat::encoded_values,
          .open = open};
}

bool is_brand(Head h, std::string_view brands) {
  return h.find("ftyp") == 4 && h.size() >= 12 && brands.find(h.substr(8, 4)) != brands.npos;
}

constexpr FileFormat efficiency(std::string_view title, bool (*is_head)(Head)) {
  return {.name = "heif",
          .title = title,
          .is_head = is_head,
          .abilities = FileFormat::encoded_values | FileFormat::gain_map,
          .open = [](Image& i, const ImageChoice& c) { read_heif_colours(*i.file, c.headroom, i.found); }};
}

// In the order in which people are told of them.
constexpr FileFormat table[] = {
    openexr,
    radiance,
    float_map,
    ktx_of_2020,
    ktx_of_2010,
    directx,
    babylon,
    gltf_light,
    tagged_images,
    portable_network,
    other("pnm", "PNM", ppm, bytes, [](Head h) { return is_pnm(h, "123456"); }),
    photographs,
    other("targa", "TGA", targa, bytes, nullptr, true,
          [](Image& i, const ImageChoice&) { read_targa_colours(*i.file, i.found); }),
    other(
        "bmp", "BMP", bmp, bytes, [](Head h) { return h.starts_with("BM"); }, false,
        [](Image& i, const ImageChoice&) { read_bmp_colours(*i.file, i.found); }),
    other(
        "webp", "WebP", webp, bytes, [](Head h) { return h.starts_with("RIFF") && h.find("WEBP") == 8; }, false,
        [](Image& i, const ImageChoice&) { read_webp_colours(*i.file, i.found); }),
    other(
        "jpeg2000", "JPEG 2000", {}, {},
        [](Head h) { return h.find("jP  ") == 4 || h.starts_with("\xff\x4f\xff\x51"); }, false,
        [](Image& i, const ImageChoice&) { read_jpeg2000_colours(*i.file, i.found); }),
    other(
        "gif", "GIF", {}, {}, [](Head h) { return h.starts_with("GIF8"); }, false,
        [](Image& i, const ImageChoice&) { read_gif_colours(*i.file, i.found); }),
    other("psd", "PSD", {}, {}, [](Head h) { return h.starts_with("8BPS"); }),
    efficiency("HEIF", [](Head h) { return is_brand(h, "heic heix heim heis hevc hevx mif1 msf1"); }),
    efficiency("AVIF", [](Head h) { return is_brand(h, "avif avis"); }),
    other("sgi", "SGI", {}, {}, [](Head h) { return h.starts_with("\x01\xda"); }),
};

}  // namespace

std::span<const FileFormat> file_formats() { return table; }

const FileFormat* format_with_extension(std::string_view extension) {
  const auto found = std::ranges::find_if(table, [&](const FileFormat& f) {
    return std::ranges::find(f.extensions, extension) != f.extensions.end();
  });
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
  std::vector<std::string_view> titles;
  for (const FileFormat& f : table) titles.push_back(f.title);
  return enumerated(titles);
}

std::string writable_extensions(Projection projection, bool levels) {
  std::vector<std::string> names;
  for (const FileFormat& f : table) {
    const bool fits = f.levels || !levels, whole = !f.cubes_alone || (projection == Projection::cube && levels);
    if (f.is_written() && !f.irradiance && fits && whole) names.push_back(fmt::format(".{}", f.extensions.front()));
  }
  return enumerated(names);
}

}  // namespace envmap
