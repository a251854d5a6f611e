#include "envmap/scenes/render/programs.h"

#include <fmt/format.h>

#include "envmap/map/environment_map.h"
#include "envmap/scenes/render/face_image.h"
#include "envmap/scenes/render/shaders.h"
#include "envmap/scenes/render/shading/sampled_reflection.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"

namespace envmap {
namespace {

// In the order of Unit, from unit_rays on.
constexpr std::string_view unit_names[] = {"RAYS",        "BASE_COLOUR",     "METALLIC_ROUGHNESS",
                                           "EMISSIVE",    "NORMAL",          "OCCLUSION",
                                           "COAT",        "COAT_ROUGHNESS",  "COAT_NORMAL",
                                           "SHEEN",       "SHEEN_ROUGHNESS", "ENVIRONMENT",
                                           "SURFACES",    "GLOSSY",          "SPLIT_SUM",
                                           "SHEEN_TABLE", "CORNERS",         "TANGENTS",
                                           "INSTANCES",   "MATERIALS",       "MIRROR",
                                           "SHADOWS",     "DISTANT_SHADOWS", "BEHIND",
                                           "SAMPLED"};
static_assert(std::size(unit_names) == unit_sampled + 1);

std::string number(auto value) { return std::to_string(int(value)); }

gl::Definitions constants() {
  gl::Definitions all{{"PI", fmt::format("{}", float(pi))},
                      {"APRON", fmt::format("{}.0", Level::padding)},
                      {"MAX_GLOSSY_LEVELS", number(max_glossy_levels)},
                      {"POINT", number(PunctualLight::Kind::point)},
                      {"SPOT", number(PunctualLight::Kind::spot)},
                      {"DIRECTIONAL", number(PunctualLight::Kind::directional)},
                      {"PLANE", number(ImageShape::plane)},
                      {"DISC", number(ImageShape::disc)},
                      {"BAND", number(ImageShape::band)},
                      {"REFLECTION_SAMPLES", number(reflection_samples)},
                      {"REFLECTION_TEXEL", fmt::format("{}", reflection_texel)},
                      {"LEAST_LOBE_ROUGHNESS", fmt::format("{}", least_lobe_roughness)},
                      {"MOST_DISTANT_LIGHTS", number(max_distant_lights)},
                      {"BLOCK_DISTANT_FACES", number(block_distant_faces)},
                      {"BLOCK_DISTANT_LIGHTS", number(block_distant_lights)},
                      {"CORNER", number(corner_texels)},
                      {"MATERIAL", number(material_texels)},
                      {"LEAST_SHEEN_ROUGHNESS", fmt::format("{}", least_sheen_roughness)},
                      {"SMOOTH_GLASS", fmt::format("{}", smooth_glass)},
                      {"BUFFER_LIGHTS", number(buffer_lights)},
                      {"BUFFER_SHADOW_VIEWS", number(buffer_shadow_views)},
                      {"BUFFER_MISSING", number(buffer_missing)}};
  for (std::size_t k = 0; k < std::size(unit_names); ++k) all[fmt::format("UNIT_{}", unit_names[k])] = number(k);
  return all;
}

std::string file_of(Projection p) { return fmt::format("{}.glsl", identifier(p)); }

// Those of several projections, each once.
std::vector<std::string> files_of(std::initializer_list<std::optional<Projection>> projections) {
  std::vector<std::string> files;
  for (const auto& p : projections)
    if (p && std::ranges::find(files, file_of(*p)) == files.end()) files.push_back(file_of(*p));
  return files;
}

gl::Program lighting(const std::vector<std::string>& files, gl::Definitions definitions, Projection environment) {
  definitions["ENVIRONMENT_LOCATED"] = fmt::format("{}_located", identifier(environment));
  return gl::make_program({{GL_VERTEX_SHADER, {"everywhere.vert.glsl"}}, {GL_FRAGMENT_SHADER, files}}, definitions);
}

}  // namespace

bool has_shader(Projection p) { return !shader_source(file_of(p)).empty(); }

gl::Program visibility_program(DrawMethod method, Projection image, bool holes, bool layered) {
  gl::Definitions definitions = constants();
  definitions["SHAPE"] = number(image_shape(image));
  definitions["RADIUS"] = fmt::format("{}_radius", identifier(image));
  definitions["REACH"] = fmt::format("{:.7}", reach(image) + 1e-3);
  definitions["FILLED"] = number(filled_disc(image));
  definitions["HOLES"] = number(holes);
  definitions["LAYERED"] = number(layered);
  definitions["TESSELLATED"] = number(method == DrawMethod::tessellate);
  const bool plain = image_shape(image) == ImageShape::plane && method != DrawMethod::exact;
  const std::string last = method == DrawMethod::exact ? "exact.frag.glsl"
                           : plain                     ? "raster.frag.glsl"
                                                       : "distort.frag.glsl";
  const gl::Stage seen{GL_FRAGMENT_SHADER,
                       {"instances.glsl", "ray.glsl", "triangle.glsl", "hole.glsl", "visible.glsl", last}};
  const gl::Stage place{GL_VERTEX_SHADER, {"instances.glsl", "place.vert.glsl"}};
  // A stage that knows where directions lie in the image.
  const auto imaging = [&](GLenum kind, std::initializer_list<std::string> files) {
    gl::Stage stage{kind, {"instances.glsl", file_of(image), "images.glsl"}};
    stage.files.insert(stage.files.end(), files);
    return stage;
  };
  if (method == DrawMethod::exact)
    return gl::make_program({place, imaging(GL_GEOMETRY_SHADER, {"bounds.glsl", "exact.geom.glsl"}), seen},
                            definitions);
  if (plain) return gl::make_program({imaging(GL_VERTEX_SHADER, {"raster.vert.glsl"}), seen}, definitions);
  const gl::Stage moved = imaging(GL_GEOMETRY_SHADER, {"distort.glsl", "solid_angle.glsl", "distort.geom.glsl"});
  if (method == DrawMethod::distort) return gl::make_program({place, moved, seen}, definitions);
  return gl::make_program({{GL_VERTEX_SHADER, {"instances.glsl", "triangle.glsl", "patch.vert.glsl"}},
                           imaging(GL_TESS_CONTROL_SHADER, {"distort.glsl", "tessellate.tesc.glsl"}),
                           {GL_TESS_EVALUATION_SHADER, {"tessellate.tese.glsl"}},
                           moved,
                           seen},
                          definitions);
}

gl::Program shadow_program(bool holes) {
  gl::Definitions definitions = constants();
  definitions["HOLES"] = number(holes);
  return gl::make_program({{GL_VERTEX_SHADER,
                            {"instances.glsl", "shadow_view.glsl", "shadow_views.glsl", "shadow.vert.glsl"}},
                           {GL_FRAGMENT_SHADER,
                            {"instances.glsl", "ray.glsl", "triangle.glsl", "hole.glsl", "shadow_view.glsl",
                             "shadow_views.glsl", "shadow.frag.glsl"}}},
                          definitions);
}

gl::Program background_program(Projection environment) {
  return lighting({file_of(environment), "environment.glsl", "ray.glsl", "background.frag.glsl"}, constants(),
                  environment);
}

gl::Program adding_program() {
  return gl::make_program({{GL_VERTEX_SHADER, {"everywhere.vert.glsl"}}, {GL_FRAGMENT_SHADER, {"add.frag.glsl"}}},
                          constants());
}

gl::Program level_program(Projection map) {
  return gl::make_program({{GL_VERTEX_SHADER, {"everywhere.vert.glsl"}},
                           {GL_FRAGMENT_SHADER, {fmt::format("texel_{}.glsl", identifier(map)), "level.frag.glsl"}}},
                          constants());
}

gl::Program shading_program(const Shading& s) {
  gl::Definitions definitions = constants();
  definitions["TEXTURES"] = std::to_string(s.textures);
  definitions["COATED"] = number(s.coated);
  definitions["SHEEN"] = number(s.sheen);
  definitions["SAMPLED"] = number(s.sampled);
  definitions["BY_VERTEX"] = number(s.mirror && s.lookup == MirrorLookup::vertex);
  definitions["HAS_FOOTPRINT"] = number(s.mirror && s.lookup != MirrorLookup::vertex);
  definitions["BY_DISTANCE"] = number(s.mirror && s.lookup == MirrorLookup::distance);
  std::vector<std::string> files = files_of({s.environment, s.mirror});
  const auto add = [&](std::initializer_list<std::string> more) { files.insert(files.end(), more); };
  add({"ray.glsl", "triangle.glsl", "turned.glsl", "environment.glsl"});
  if (s.mirror)
    add({"tint.glsl", fmt::format("mirror_{}.glsl", identifier(*s.mirror)),
         fmt::format("texel_{}.glsl", identifier(*s.mirror)), "surfaces.glsl", "meet_map.glsl", "footprint.glsl",
         "reflect_mirror.glsl"});
  else
    add({s.by_picture ? "reflect_picture.glsl" : "reflect_environment.glsl"});
  if (s.sheen) add({"sheen.glsl"});
  add({"lights.glsl", "shadow_view.glsl", "shadow_views.glsl", "shadow.glsl", "occlusion.glsl"});
  if (s.sampled) add({"sampled.glsl"});
  add({"shading.glsl", "shade.frag.glsl"});
  return lighting(files, definitions, s.environment);
}

namespace {

// @param make called where the program is not there yet.
template <class Make>
const gl::Program& made(gl::Program& program, const Make& make) {
  if (program == 0) program = make();
  return program;
}

}  // namespace

const gl::Program& ProgramCache::visibility(DrawMethod method, Projection p, bool holes, bool layered) {
  return made(visibility_[{method, p, holes, layered}], [&] { return visibility_program(method, p, holes, layered); });
}

const gl::Program& ProgramCache::shadow(bool holes) {
  return made(shadow_[holes], [&] { return shadow_program(holes); });
}

const gl::Program& ProgramCache::background(Projection p) {
  return made(background_[p], [&] { return background_program(p); });
}

const gl::Program& ProgramCache::adding() { return made(adding_, adding_program); }

const gl::Program& ProgramCache::level(Projection p) {
  return made(levels_[p], [&] { return level_program(p); });
}

const gl::Program& ProgramCache::shading(const Shading& s) {
  return made(shading_[s], [&] { return shading_program(s); });
}

}  // namespace envmap
