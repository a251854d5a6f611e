#include "envmap/io/metadata.h"

#include <algorithm>
#include <sstream>

namespace envmap {
namespace {

std::string value(const OIIO::ImageSpec& spec, const std::string& key) {
  if (const std::string own = spec.get_string_attribute(key); !own.empty()) return own;
  std::istringstream words(spec.get_string_attribute("ImageDescription"));
  for (std::string word; words >> word;)
    if (word.starts_with(key + "=")) return word.substr(key.size() + 1);
  return {};
}

}  // namespace

std::optional<Forward> forward_named(std::string_view wanted) {
  const auto* found = std::ranges::find(forward_names, wanted);
  if (found == std::end(forward_names)) return std::nullopt;
  return static_cast<Forward>(found - forward_names);
}

bool has_border_samples(const OIIO::ImageSpec& spec) {
  const std::string texture = spec.get_string_attribute("textureformat");
  return texture == "LatLong Environment" || texture == "CubeFace Environment";
}

Metadata metadata(const OIIO::ImageSpec& spec) {
  // OpenEXR's own attribute comes first: its tools carry ours along from the file they converted.
  const std::string texture = spec.get_string_attribute("textureformat");
  if (texture == "LatLong Environment") return {.projection = Projection::latlong, .forward = Forward::plus_z};
  if (texture == "CubeFace Environment") return {.projection = Projection::cube, .layout = Layout::column};
  return {projection_named(value(spec, "envmap:projection")), layout_named(value(spec, "envmap:layout")),
          forward_named(value(spec, "envmap:forward"))};
}

void set_metadata(OIIO::ImageSpec& spec, const Metadata& data) {
  std::string words;
  const auto set = [&](const std::string& key, std::string_view text) {
    spec.attribute(key, std::string(text));
    words += (words.empty() ? "" : " ") + key + "=" + std::string(text);
  };
  if (data.projection) set("envmap:projection", name(*data.projection));
  if (data.layout) set("envmap:layout", name(*data.layout));
  if (data.forward) set("envmap:forward", forward_names[static_cast<std::size_t>(*data.forward)]);
  spec.attribute("ImageDescription", words);
}

}  // namespace envmap
