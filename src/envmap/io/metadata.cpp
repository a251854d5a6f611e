#include "envmap/io/metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace envmap {
namespace {

constexpr std::string_view prefix = "envmap:";

// Name and value of every attribute envmap:NAME, the first of each; attributes before words of the image description.
Facts all_facts(const Attributes& texts) {
  Facts facts;
  const auto add = [&](const std::string& name, const std::string& text) {
    if (is_word(name) && is_word(text)) facts.emplace(name, text);
  };
  for (const auto& [name, text] : texts)
    if (name.starts_with(prefix)) add(name.substr(prefix.size()), text);
  const auto described = texts.find(description);
  std::istringstream words(described == texts.end() ? "" : described->second);
  for (std::string word; words >> word;)
    if (const auto equals = word.find('='); word.starts_with(prefix) && equals != std::string::npos)
      add(word.substr(prefix.size(), equals - prefix.size()), word.substr(equals + 1));
  return facts;
}

// What people wrote into the description, without the words envmap:NAME=TEXT that this program added, and the owner.
Provenance provenance(const ImageFacts& image) {
  constexpr std::size_t longest = 1 << 14;  // JPEG, for one, holds 64 kB.
  Provenance p = image.provenance;
  const auto text = [&](const char* name) {
    const auto found = image.attributes.find(name);
    return found != image.attributes.end() && found->second.size() <= longest ? found->second : std::string();
  };
  p.owner = text(copyright);
  const std::string described = text(description);
  for (std::size_t at = 0, next = 0; at < described.size(); at = next) {
    next = std::min(described.find_first_of(" \n", at), described.size() - 1) + 1;
    const std::string word = described.substr(at, next - at);
    if (!word.starts_with(prefix) || word.find('=') == word.npos) p.comments += word;
  }
  while (p.comments.ends_with(' ') || p.comments.ends_with('\n')) p.comments.pop_back();
  return p;
}

std::optional<int> number(const std::string& text) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error == std::errc() && end == text.data() + text.size() && n > 0 ? std::optional(n) : std::nullopt;
}

std::optional<float> luminance(const std::string& text) {
  float n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && n > 0 && std::isfinite(n) ? std::optional(n) : std::nullopt;
}

}  // namespace

std::optional<Forward> forward_named(std::string_view wanted) {
  const auto* found = std::ranges::find(forward_names, wanted);
  if (found == std::end(forward_names)) return std::nullopt;
  return static_cast<Forward>(found - forward_names);
}

bool has_border_samples(const Attributes& texts) {
  const auto texture = texts.find("textureformat");
  return texture != texts.end() &&
         (texture->second == "LatLong Environment" || texture->second == "CubeFace Environment");
}

Metadata metadata(const ImageFacts& image) {
  // OpenEXR's own attribute comes first: its tools carry ours along from the file they converted, and OpenImageIO's
  // name for theirs, too. The shape tells what they made of it: they know 2:1 and 1:6.
  Metadata data = metadata(all_facts(image.attributes));
  if (has_border_samples(image.attributes)) {
    const bool is_cube = image.height == 6 * image.width;
    const Projection is = is_cube ? Projection::cube : Projection::latlong;
    if (data.projection != is) data = {};  // Of the file that it was made from.
    data.projection = is;
    data.layout = is_cube ? std::optional(Layout::column) : std::nullopt;
    data.forward = is_cube ? std::nullopt : std::optional(Forward::plus_z);
  }
  const std::optional<float> white = data.provenance.white_luminance;
  data.provenance = provenance(image);
  if (!data.provenance.white_luminance) data.provenance.white_luminance = white;
  return data;
}

bool is_word(const std::string& text) {
  return !text.empty() && text.size() < 100 &&
         std::ranges::all_of(text, [](unsigned char c) { return c > ' ' && c < 0x7f && c != '='; });
}

Metadata metadata(Facts facts) {
  const auto take = [&](const char* name) {
    const auto node = facts.extract(name);
    return node ? node.mapped() : std::string();
  };
  Metadata data{projection_named(take("projection")), layout_named(take("layout")), forward_named(take("forward")),
                number(take("levels")), number(take("border"))};
  data.space = take("space");
  data.provenance.white_luminance = luminance(take("white"));
  data.facts = std::move(facts);
  return data;
}

Facts facts(const Metadata& data) {
  Facts all = data.facts;
  if (data.projection) all["projection"] = name(*data.projection);
  if (data.layout) all["layout"] = name(*data.layout);
  if (data.forward) all["forward"] = forward_names[number_of("forward", *data.forward)];
  if (data.levels) all["levels"] = std::to_string(*data.levels);
  if (data.border) all["border"] = std::to_string(*data.border);
  if (!data.space.empty()) all["space"] = data.space;
  if (const auto& white = data.provenance.white_luminance) all["white"] = fmt::format("{}", *white);
  return all;
}

Attributes attributes(const Metadata& data) {
  Attributes texts;
  std::string words;
  for (const auto& [key, text] : facts(data)) {
    texts[std::string(prefix) + key] = text;
    words += fmt::format("{}{}{}={}", words.empty() ? "" : " ", prefix, key, text);
  }
  // First, as Targa's description is cut after 324 characters.
  texts[description] =
      words + (words.empty() || data.provenance.comments.empty() ? "" : " ") + data.provenance.comments;
  if (!data.provenance.owner.empty()) texts[copyright] = data.provenance.owner;
  return texts;
}

}  // namespace envmap
