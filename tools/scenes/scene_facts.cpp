#include "scenes/scene_facts.h"

#include <fmt/format.h>

#include <vector>

#include "envmap/scenes/render/draw.h"

namespace tools {

using namespace envmap;

namespace {

// Counts the triangles of each node and of the nodes below it.
std::vector<std::size_t> triangles_of_nodes(const SceneGraph& scene) {
  std::vector<std::size_t> counts(scene.nodes.size());
  for (const Instance& i : instances(scene))
    for (int node = i.node; node >= 0; node = scene.nodes[std::size_t(node)].parent)
      counts[std::size_t(node)] += scene.meshes[std::size_t(i.mesh)].indices.size() / 3;
  return counts;
}

const char* kind_of(const PunctualLight& light) {
  return light.kind == PunctualLight::Kind::point  ? "point"
         : light.kind == PunctualLight::Kind::spot ? "spot"
                                                   : "directional";
}

std::string counted(std::size_t count, const char* what, const char* more = "s") {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : more);
}

}  // namespace

void add(Report& report, const SceneGraph& scene) {
  const std::vector<Direction> centres = centres_of_nodes(scene, pose(scene, 0));
  const std::vector<std::size_t> counts = triangles_of_nodes(scene);
  const auto name_of = [&](int node) { return scene.nodes[std::size_t(node)].name; };
  report.put("scene.triangles", triangles(scene));
  report.put("scene.meshes", instances(scene).size());
  report.put("scene.materials", scene.materials.size());
  report.put("scene.animations", scene.animations.size());
  for (const char* list : {"scene.nodes", "scene.cameras", "scene.lights"}) report.put_array(list);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    report.append("scene.nodes[]");
    report.put("scene.nodes[].name", scene.nodes[k].name);
    report.put("scene.nodes[].triangles", counts[k]);
    report.put("scene.nodes[].centre", centres[k]);
  }
  for (const Camera& camera : scene.cameras) {
    report.append("scene.cameras[]");
    report.put("scene.cameras[].name", camera.name);
    report.put("scene.cameras[].node", name_of(camera.node));
  }
  for (const PunctualLight& light : scene.lights) {
    report.append("scene.lights[]");
    report.put("scene.lights[].kind", kind_of(light));
    report.put("scene.lights[].node", name_of(light.node));
  }
}

FactLines lines_of(const SceneGraph& scene, const std::string& file) {
  const std::vector<Direction> centres = centres_of_nodes(scene, pose(scene, 0));
  const std::vector<std::size_t> counts = triangles_of_nodes(scene);
  FactLines lines{
      {"file", file},
      {"scene", fmt::format("{} in {}, {}, {}, {}", counted(triangles(scene), "triangle"),
                            counted(instances(scene).size(), "mesh", "es"), counted(scene.materials.size(), "material"),
                            counted(scene.lights.size(), "light"), counted(scene.cameras.size(), "camera"))}};
  for (const Camera& camera : scene.cameras)
    lines.emplace_back("camera",
                       fmt::format("'{}' at node '{}'", camera.name, scene.nodes[std::size_t(camera.node)].name));
  for (const PunctualLight& light : scene.lights)
    lines.emplace_back("light",
                       fmt::format("{} at node '{}'", kind_of(light), scene.nodes[std::size_t(light.node)].name));
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const Direction& centre = centres[k];
    lines.emplace_back("node", fmt::format("'{}', {}, centre {:.4g},{:.4g},{:.4g}", scene.nodes[k].name,
                                           counted(counts[k], "triangle"), centre.x, centre.y, centre.z));
  }
  return lines;
}

}  // namespace tools
