#include "envmap/io/claims/colour_config.h"

#include <algorithm>
#include <string>

namespace envmap {
namespace {

constexpr std::string_view rec709_names[] = {
    "Linear Rec.709 (sRGB)", "lin_rec709", "lin_srgb", "rec709", "linear", "Linear sRGB"};
constexpr std::string_view srgb_names[] = {"srgb_tx", "sRGB - Texture", "srgb_texture"};
constexpr std::string_view acescg_names[] = {"ACES - ACEScg", "lin_ap1", "ap1"};
constexpr std::string_view aces_names[] = {"ACES - ACES2065-1", "lin_ap0", "ap0"};
constexpr std::string_view rec2020_names[] = {"Rec.2020", "lin_rec2020", "rec2020"};
constexpr std::string_view xyz_names[] = {"CIE-XYZ-D65", "CIE XYZ-D65", "lin_ciexyzd65"};
constexpr std::string_view p3_names[] = {"lin_p3d65", "p3", "P3-D65"};
constexpr std::string_view display_p3_names[] = {"display_p3", "DisplayP3"};

constexpr BuiltInSpace spaces[] = {
    {linear_rec709, rec709_names, rec709, linear_rec709},
    {"sRGB", srgb_names, rec709, linear_rec709},
    {"ACEScg", acescg_names, aces_ap1, "ACEScg"},
    {aces2065_1, aces_names, aces_ap0, aces2065_1},
    {"Linear Rec.2020", rec2020_names, rec2020, "Linear Rec.2020"},
    {"XYZ", xyz_names, cie_xyz, "XYZ"},
    {"Linear P3-D65", p3_names, p3_d65, "Linear P3-D65"},
    {"Display P3", display_p3_names, p3_d65, "Linear P3-D65"},
};

constexpr std::pair<const char*, const char*> roles[] = {{"scene_linear", linear_rec709},
                                                         {"default", linear_rec709},
                                                         {"texture_paint", "sRGB"},
                                                         {"aces_interchange", aces2065_1}};

bool same_word(std::string_view a, std::string_view b) {
  const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, small, small);
}

ocio::MatrixTransformRcPtr to_reference(const Primaries& primaries) {
  const ColourMatrix m = conversion(primaries, rec709);
  const double rows[16] = {m[0].x, m[1].x, m[2].x, 0, m[0].y, m[1].y, m[2].y, 0, m[0].z, m[1].z, m[2].z, 0, 0, 0, 0, 1};
  const auto transform = ocio::MatrixTransform::Create();
  transform->setMatrix(rows);
  return transform;
}

void add_space(ocio::Config& config, const BuiltInSpace& space) {
  const auto to = ocio::GroupTransform::Create();
  if (!space.is_linear()) to->appendTransform(srgb_curve());
  to->appendTransform(to_reference(space.primaries));
  const auto added = ocio::ColorSpace::Create();
  added->setName(std::string(space.name).c_str());
  for (const std::string_view alias : space.aliases) added->addAlias(std::string(alias).c_str());
  added->setTransform(to, ocio::COLORSPACE_DIR_TO_REFERENCE);
  config.addColorSpace(added);
}

ocio::ConfigRcPtr make_config() {
  const ocio::ConfigRcPtr config = ocio::Config::Create();
  for (const BuiltInSpace& space : spaces) add_space(*config, space);
  for (const auto& [role, name] : roles) config->setRole(role, name);
  return config;
}

}  // namespace

std::span<const BuiltInSpace> built_in_spaces() { return spaces; }

const BuiltInSpace* built_in_space(std::string_view name) {
  for (const auto& [role, named] : roles)
    if (same_word(name, role)) name = named;
  for (const BuiltInSpace& space : spaces) {
    if (same_word(space.name, name)) return &space;
    for (const std::string_view alias : space.aliases)
      if (same_word(alias, name)) return &space;
  }
  return nullptr;
}

ocio::ConstConfigRcPtr built_in_config() {
  static const ocio::ConstConfigRcPtr config = make_config();
  return config;
}

ocio::ConstConfigRcPtr config_with(const Primaries& primaries, const char* name) {
  const ocio::ConfigRcPtr config = make_config();
  add_space(*config, {name, {}, primaries, name});
  return config;
}

ocio::ExponentWithLinearTransformRcPtr srgb_curve() {
  const auto curve = ocio::ExponentWithLinearTransform::Create();
  curve->setGamma({2.4, 2.4, 2.4, 1.0});
  curve->setOffset({0.055, 0.055, 0.055, 0.0});
  return curve;
}

ocio::ConstCPUProcessorRcPtr on_cpu(const ocio::ConstProcessorRcPtr& processor) {
  return processor->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);
}

void apply(const ocio::ConstCPUProcessorRcPtr& processor, std::span<Colour> colours) {
  if (colours.empty()) return;
  ocio::PackedImageDesc image(colours.data(), static_cast<long>(colours.size()), 1, 3);
  processor->apply(image);
}

}  // namespace envmap
