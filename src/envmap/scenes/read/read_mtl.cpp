#include "envmap/scenes/read/read_mtl.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "envmap/scenes/read/text_lines.h"
#include "envmap/scenes/scene/mesh.h"

namespace envmap {
namespace {

// What lines say of a material before they are put together.
struct Statements {
  MtlMaterial found;
  std::optional<Colour> diffuse, specular, emissive;
  std::optional<float> roughness;
  float exponent = 0;
  int illumination = 2;

  void note_unsupported(const char* what) { note_once(found.unsupported, what); }
};

std::string lower(std::string_view text) {
  std::string made(text);
  std::ranges::transform(made, made.begin(), [](unsigned char c) { return std::tolower(c); });
  return made;
}

// One number is grey. Colours may also be the name of a file of spectra, or CIE XYZ: those are left as they were.
std::optional<Colour> colour(Words& words, Statements& s) {
  const std::string kind = lower(words.peek());
  if (kind == "spectral" || kind == "xyz") return s.note_unsupported("colours as spectra or CIE XYZ"), std::nullopt;
  const float red = words.number(), green = words.number(red), blue = words.number(green);
  if (red < 0 || green < 0 || blue < 0) words.fail("a colour is negative");
  return Colour(red, green, blue);
}

bool is_number(std::string_view word) {
  return word.find_first_of("0123456789") != word.npos && word.find_first_not_of("+-.0123456789eE") == word.npos;
}

// Options, then the name, which may hold spaces.
MtlMap map(Words& words, Statements& s) {
  constexpr std::string_view of_one_word[] = {"-blendu", "-blendv", "-cc",    "-imfchan",
                                              "-type",   "-bm",     "-boost", "-texres"};
  MtlMap made;
  // Up to three numbers, which say that nothing is to be done.
  const auto expect = [&](std::initializer_list<float> nothing, const char* otherwise) {
    for (const float value : nothing)
      if (is_number(words.peek()) && words.number() != value) s.note_unsupported(otherwise);
  };
  while (words.peek().starts_with('-')) {
    const std::string option = lower(words.word());
    if (option == "-clamp")
      made.clamp = lower(words.word()) == "on";
    else if (option == "-o" || option == "-t")
      expect({0, 0, 0}, "moved textures");
    else if (option == "-s")
      expect({1, 1, 1}, "scaled textures");
    else if (option == "-mm")
      expect({0, 1}, "textures of changed contrast");
    else if (std::ranges::find(of_one_word, option) != std::end(of_one_word))
      words.word();
    else
      words.fail("unknown option " + quoted(option) + " of a texture");
  }
  made.name = words.name();
  if (made.name.empty()) words.fail("a texture has no name");
  std::ranges::replace(made.name, '\\', '/');  // As written on Windows.
  return made;
}

// These functions return whether they know the statement.
bool read_number(const std::string& key, Words& words, Statements& s) {
  Material& m = s.found.material;
  const auto bounded = [&](float least, float most) { return std::clamp(words.number(), least, most); };
  if (key == "ns") {
    s.exponent = bounded(0, 1e8F);
  } else if (key == "ni") {
    m.ior = bounded(1, 1e6F);
  } else if (key == "illum") {
    s.illumination = int(bounded(0, 10));
  } else if (key == "pr") {
    s.roughness = bounded(0, 1);
  } else if (key == "pm") {
    m.metallic = bounded(0, 1);
  } else if (key == "pc") {
    m.coat = bounded(0, 1);
  } else if (key == "pcr") {
    m.coat_roughness = bounded(0, 1);
  } else if (key == "tr") {
    if (words.number() > 0) s.note_unsupported("alpha blending");
  } else if (key == "d") {
    if (lower(words.peek()) == "-halo") words.word();
    if (words.number() < 1) s.note_unsupported("alpha blending");
  } else if (key == "ps" || key == "aniso") {
    if (words.number() != 0) s.note_unsupported("sheen and anisotropy");
  } else {
    return key == "anisor" || key == "sharpness";
  }
  return true;
}

bool read_colour(const std::string& key, Words& words, Statements& s) {
  const auto take = [&](std::optional<Colour>& to) {
    if (const auto found = colour(words, s)) to = found;
  };
  std::optional<Colour> nowhere;
  if (key == "kd")
    take(s.diffuse);
  else if (key == "ks")
    take(s.specular);
  else if (key == "ke")
    take(s.emissive);
  else if (key == "ka" || key == "tf" || key == "km")
    take(nowhere);
  else
    return false;
  return true;
}

bool read_map(const std::string& key, Words& words, Statements& s) {
  if (key == "map_kd")
    s.found.colour = map(words, s);
  else if (key == "map_ke")
    s.found.emission = map(words, s);
  else if (key == "map_d" || key == "map_tr")
    map(words, s), s.note_unsupported("alpha blending");
  else if (key == "bump" || key == "map_bump" || key == "norm" || key == "map_kn")
    map(words, s), s.note_unsupported("normal maps");
  else if (key == "disp" || key == "map_disp")
    map(words, s), s.note_unsupported("displacement");
  else if (key == "map_pr" || key == "map_pm" || key == "map_ns" || key == "map_ks")
    map(words, s), s.note_unsupported("textures of roughness, metalness and highlights");
  else if (key == "map_ka" || key == "refl" || key == "decal" || key.starts_with("map_"))
    (void)words.name();
  else
    return false;
  return true;
}

MtlMaterial finished(Statements& s) {
  Material& m = s.found.material;
  m.base_colour = glm::vec4(s.diffuse.value_or(Colour(1)), 1);
  m.emissive = s.emissive.value_or(Colour(0));
  if (!s.found.emission.name.empty() && m.emissive == Colour(0)) m.emissive = Colour(1);
  // Blinn and Phong's exponent n and GGX's alpha fall off alike near the peak where n = 2 / alpha^2 - 2 (Walter et al.
  // 2007).
  m.roughness = s.roughness.value_or(std::pow(2 / (s.exponent + 2), 0.25F));
  // No index of refraction, no highlight.
  if (s.illumination < 2 || s.specular == Colour(0)) m.ior = 1;
  m.double_sided = true;  // OBJ knows no inside.
  return std::move(s.found);
}

}  // namespace

std::map<std::string, MtlMaterial> read_mtl(std::string_view text) {
  check_text(text);
  std::map<std::string, Statements> all;
  Statements* now = nullptr;
  for (TextLines lines(text); lines.next();) {
    Words words(lines);
    const std::string key = lower(words.word());
    if (key.empty()) continue;
    if (key == "newmtl") {
      const std::string name = words.name();
      now = &all[name];
      now->found.material.name = name;
      continue;
    }
    if (now == nullptr) words.fail(quoted(key) + " stands before the first newmtl");
    if (!read_number(key, words, *now) && !read_colour(key, words, *now) && !read_map(key, words, *now))
      now->note_unsupported("unknown statements of MTL");
  }
  std::map<std::string, MtlMaterial> made;
  for (auto& [name, statements] : all) made.emplace(name, finished(statements));
  return made;
}

}  // namespace envmap
