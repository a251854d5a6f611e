#include "envmap/engine/lookup_shaders.h"

#include <algorithm>
#include <map>
#include <string>

namespace envmap {
namespace {

constexpr std::string_view glsl_head = R"(// Lookups of environment maps, written by 'envmap bake --for glsl'.
// Beside it lie background.ktx2 (the environment), specular.ktx2, brdf.exr and irradiance.txt.
// For GLSL 3.30 and GLSL ES 3.00. Put this text behind #version, and in GLSL ES behind
// precision highp float; precision highp samplerCube; precision highp sampler2D;
)";

constexpr std::string_view hlsl_head = R"(// Lookups of environment maps, written by 'envmap bake --for hlsl'.
// Beside it lie background.dds (the environment), specular.dds, brdf.exr and irradiance.txt.
// For HLSL, shader model 4 and newer.
)";

bool in_name(char c) { return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Takes the next name, or else one character, from the front of a text.
std::string_view take(std::string_view& text) {
  const auto end = std::ranges::find_if_not(text, in_name);
  const auto length = std::max<std::size_t>(1, std::size_t(end - text.begin()));
  const std::string_view token = text.substr(0, length);
  text.remove_prefix(length);
  return token;
}

std::string in_hlsl(std::string_view glsl) {
  static const std::map<std::string_view, std::string_view> names{
      {"vec2", "float2"}, {"vec3", "float3"}, {"vec4", "float4"}, {"atan", "atan2"}, {"inversesqrt", "rsqrt"}};
  static const std::map<std::string_view, std::string_view> textures{{"samplerCube", "TextureCube"},
                                                                     {"sampler2D", "Texture2D"}};
  std::string hlsl;
  while (!glsl.empty()) {
    const std::string_view token = take(glsl);
    if (const auto texture = textures.find(token); texture != textures.end()) {
      take(glsl);  // The space.
      const std::string name(take(glsl));
      hlsl += std::string(texture->second) + " " + name + ", SamplerState " + name + "_sampler";
    } else if (token == "textureLod") {
      take(glsl);  // The bracket.
      const std::string name(take(glsl));
      hlsl += name + ".SampleLevel(" + name + "_sampler";
    } else {
      const auto name = names.find(token);
      hlsl += name == names.end() ? token : name->second;
    }
  }
  return hlsl;
}

}  // namespace

std::string_view glsl_lookups() {
  static const std::string text = std::string(glsl_head) + std::string(lookup_source("envmap.glsl"));
  return text;
}

std::string_view hlsl_lookups() {
  static const std::string text = std::string(hlsl_head) + in_hlsl(lookup_source("envmap.glsl"));
  return text;
}

}  // namespace envmap
