#include "envmap/io/formats/babylon_env.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "envmap/base/error.h"
#include "envmap/io/texels/rgbd.h"
#include "envmap/io/write_plan.h"

namespace envmap {
namespace {

/// From 0 to 2^53, also where it is written as 12.0. What the library makes of -1 or 1e80 is another number, or none.
/// @param json of nlohmann's. @throws InputError without the file's name.
template <class Json>
std::uint64_t whole_number(const Json& json) {
  const double number = json.is_number() ? json.template get<double>() : -1;
  if (!(number >= 0 && number <= 0x1p53 && number == std::floor(number)))
    throw InputError("damaged: its JSON has no whole number where one must be");
  return std::uint64_t(number);
}

using Json = nlohmann::ordered_json;

// How a level goes with roughness: lod = 0.8 log2(size x alpha), Babylon.js' own value.
constexpr double lod_generation_scale = 0.8;
constexpr std::size_t longest_header = 1 << 20;

// The text between the mark and a NUL.
std::string header_of(const InputFile& file) {
  std::string text(std::min<std::uint64_t>(longest_header,
                                           file.size() - std::min<std::uint64_t>(file.size(), env_mark.size())),
                   '\0');
  text.resize(file.pread(text.data(), text.size(), env_mark.size()));
  const std::size_t end = text.find('\0');
  if (end == std::string::npos) throw InputError("truncated or damaged: its header has no end");
  text.resize(end);
  return text;
}

struct FilePart {
  std::uint64_t offset, size;
};

std::vector<FilePart> parts_of(const Json& header, std::uint64_t start, std::uint64_t end) {
  std::vector<FilePart> parts;
  for (const Json& image : header.at("specular").at("mipmaps")) {
    const std::uint64_t position = whole_number(image.at("position")), length = whole_number(image.at("length"));
    if (position > end || start + position > end) throw InputError("truncated or damaged: a face lies beyond its end");
    parts.push_back({start + position, length});
  }
  return parts;
}

// The header's irradiance: a polynomial, and the faces of a cube, which lie behind the levels. @param position of the
// first of them.
Json irradiance_of(const KeyValues& pairs, std::size_t position) {
  const auto polynomial = pairs.find("irradiance"), cube = pairs.find("irradianceTexture");
  Json irradiance = polynomial == pairs.end() ? Json() : Json::parse(polynomial->second);
  if (cube == pairs.end()) return irradiance;
  Json about = Json::parse(cube->second), faces = Json::array();
  for (const Json& length : about.at("lengths")) {
    faces.push_back({{"length", length}, {"position", position}});
    position += length.get<std::size_t>();
  }
  about.erase("lengths");
  about["faces"] = faces;
  irradiance["irradianceTexture"] = about;
  return irradiance;
}

std::vector<char> bytes_of(std::string_view digits) {
  const auto value = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  std::vector<char> bytes;
  for (std::size_t k = 0; k + 1 < digits.size(); k += 2)
    bytes.push_back(char(16 * value(digits[k]) + value(digits[k + 1])));
  return bytes;
}

}  // namespace

void write_env(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  const auto size = unsigned(levels[0].width());
  if (!std::has_single_bit(size))
    throw OutputError(fmt::format(".env files need a power of two as the height of a face, such as {}, not {}",
                                  std::bit_floor(size), size));
  if (const int all = std::bit_width(size); levels.size() != std::size_t(all))
    throw OutputError(fmt::format(".env files hold all levels down to one texel, which are {} here, not {}", all,
                                  levels.size()),
                      Remedy::make_all_levels);
  const std::vector<RgbdFaces> faces = rgbd_faces(levels, progress);
  Json images = Json::array();
  std::size_t position = 0;
  for (const RgbdFaces& level : faces)
    for (const std::vector<char>& image : level) {
      images.push_back({{"length", image.size()}, {"position", position}});
      position += image.size();
    }
  const Json header{{"version", 2},
                    {"width", size},
                    {"imageType", "image/png"},
                    {"irradiance", irradiance_of(plan.pairs, position)},
                    {"specular", {{"mipmaps", images}, {"lodGenerationScale", lod_generation_scale}}}};
  const std::string text = header.dump();
  file.write(env_mark.data(), env_mark.size());
  file.write(text.c_str(), text.size() + 1);
  for (const RgbdFaces& level : faces)
    for (const std::vector<char>& image : level) file.write(image.data(), image.size());
  if (const auto cube = plan.pairs.find("irradianceFaces"); cube != plan.pairs.end()) {
    const std::vector<char> bytes = bytes_of(cube->second);
    file.write(bytes.data(), bytes.size());
  }
}

TextureFile open_env(const InputFile& file) {
  const std::string text = header_of(file);
  try {
    const Json header = Json::parse(text);
    const std::uint64_t version = whole_number(header.at("version"));
    if (version < 1 || version > 2)
      throw InputError(fmt::format("is an .env file of version {}: only versions 1 and 2 can be read", version));
    if (const std::string type = header.value("imageType", "image/png"); type != "image/png")
      throw InputError(fmt::format(
          "not supported: faces that are {} images: export the .env file with image/png, Babylon.js' default", type));
    const std::vector<FilePart> parts = parts_of(header, env_mark.size() + text.size() + 1, file.size());
    const auto image = [parts](const InputFile& from, std::size_t k) {
      return read_bytes(from, parts[k].offset, parts[k].size);
    };
    return rgbd_texture(file, "env", parts.size(), image, file.size());
  } catch (const Json::exception&) {
    throw InputError("damaged: its header is not that of an .env file");
  }
}

}  // namespace envmap
