#include "envmap/scenes/scene/skin_and_morph.h"

#include <cmath>

#include "envmap/scenes/scene/keyframes.h"
#include "envmap/scenes/scene/mesh.h"

namespace envmap {
namespace {

void add(std::vector<glm::vec3>& to, const std::vector<glm::vec3>& displacements, double weight) {
  for (std::size_t k = 0; k < displacements.size(); ++k) to[k] += float(weight) * displacements[k];
}

void morph(const Deformation& d, double time, Vertices& v) {
  const std::valarray<double> weights = value_at(d.keys, time, d.weights);
  for (std::size_t k = 0; k < d.targets.size(); ++k) {
    const Vertices& target = d.targets[k];
    if (weights[k] == 0) continue;
    add(v.positions, target.positions, weights[k]);
    add(v.normals, target.normals, weights[k]);
    for (std::size_t n = 0; n < std::min(v.tangents.size(), target.tangents.size()); ++n)
      v.tangents[n] += float(weights[k]) * glm::vec4(glm::vec3(target.tangents[n]), 0);
  }
  for (std::size_t n = 0; n < v.normals.size(); ++n)
    v.normals[n] = glm::vec3(unit(Direction(v.normals[n]), Direction(d.rest.normals[n])));
}

// The node's own matrix moves nothing: what the joints say is brought into its frame.
void skin(const Deformation& d, const Pose& pose, Vertices& v) {
  const Matrix& own = pose[std::size_t(d.node)];
  if (d.joints.empty() || glm::determinant(own) == 0) return;
  const Matrix from_world = glm::inverse(own);
  std::vector<Matrix> of_joint;
  for (std::size_t k = 0; k < d.joints.size(); ++k)
    of_joint.push_back(from_world * pose[std::size_t(d.joints[k])] * d.inverse_bind[k]);
  for (std::size_t n = 0; n < v.positions.size(); ++n) {
    Matrix m(0);
    for (int k = 0; k < 4; ++k)
      if (d.parts[n][k] != 0) m += of_joint[d.influences[n][k]] * double(d.parts[n][k]);
    const Rotation turn(m);
    v.positions[n] = glm::vec3(m * glm::dvec4(v.positions[n], 1));
    const double sign = glm::determinant(turn) < 0 ? -1 : 1;
    v.normals[n] = glm::vec3(unit(sign * (cofactors(turn) * Direction(v.normals[n])), Direction(v.normals[n])));
    if (!v.tangents.empty()) v.tangents[n] = glm::vec4(glm::vec3(turn * Direction(v.tangents[n])), v.tangents[n].w);
  }
}

}  // namespace

std::vector<int> deform(SceneGraph& scene, const Pose& pose, double time) {
  std::vector<int> moved;
  for (const Deformation& d : scene.deformations) {
    Mesh& mesh = scene.meshes[std::size_t(d.mesh)];
    Vertices now = d.rest;
    morph(d, time, now);
    skin(d, pose, now);
    for (std::size_t n = 0; n < now.positions.size(); ++n)  // Weights and matrices may be of any size.
      if (!std::isfinite(glm::length(Direction(now.positions[n])))) now.positions[n] = d.rest.positions[n];
    const bool is_other = now.positions != mesh.positions || (!d.flat && now.normals != mesh.normals);
    mesh.positions = std::move(now.positions);
    if (!d.flat) mesh.normals = std::move(now.normals);
    mesh.tangents = std::move(now.tangents);
    if (d.flat) make_normals_flat(mesh);
    if (is_other) moved.push_back(d.mesh);
  }
  return moved;
}

}  // namespace envmap
