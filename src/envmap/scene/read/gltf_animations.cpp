#include <map>
#include <string>

#include "envmap/scene/mesh.h"
#include "envmap/scene/read/gltf_reader.h"

namespace envmap {
namespace {

// Pieces that a cubic spline between two keys is drawn in: straight ones, off by 1/500 of its bow.
constexpr int pieces = 16;

Quaternion as(const std::vector<double>& v, std::size_t at, std::size_t, const Quaternion*) {
  return Quaternion(v[at + 3], v[at], v[at + 1], v[at + 2]);
}
Direction as(const std::vector<double>& v, std::size_t at, std::size_t, const Direction*) {
  return {v[at], v[at + 1], v[at + 2]};
}

std::valarray<double> as(const std::vector<double>& v, std::size_t at, std::size_t wide, const std::valarray<double>*) {
  return {v.data() + at, wide};
}

// @param wide numbers of a value, which are in the accessor as elements of so many components.
template <class T>
std::vector<Animation::Key<T>> read_keys(const GltfDocument& document, const Field& sampler, std::size_t wide,
                                         int components) {
  constexpr const T* kind = nullptr;
  const std::vector<double> times = accessor_numbers(document, sampler["input"], 1);
  const std::vector<double> values = accessor_numbers(document, sampler["output"], components);
  const std::string between = sampler["interpolation"].text("LINEAR");
  const bool cubic = between == "CUBICSPLINE", steps = between == "STEP";
  if (!cubic && !steps && between != "LINEAR") sampler["interpolation"].fail("is '" + between + "', no interpolation");
  if (values.size() != times.size() * wide * (cubic ? 3 : 1))
    sampler["output"].fail("does not have a value for each time");
  std::vector<Animation::Key<T>> keys;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (k > 0 && !(times[k] > times[k - 1])) sampler["input"].fail("holds times that do not rise");
    if (k > 0 && steps) keys.push_back({times[k], keys.back().value});
    if (k > 0 && cubic) {
      // Hermite's spline (specification, appendix C.4); in tangent, value and out tangent stand together.
      const T p0 = as(values, (3 * k - 2) * wide, wide, kind), m0 = as(values, (3 * k - 1) * wide, wide, kind);
      const T p1 = as(values, (3 * k + 1) * wide, wide, kind), m1 = as(values, 3 * k * wide, wide, kind);
      const double span = times[k] - times[k - 1];
      for (int piece = 1; piece < pieces; ++piece) {
        const double t = double(piece) / pieces, t2 = t * t, t3 = t2 * t;
        keys.push_back({times[k - 1] + t * span, T(p0 * (2 * t3 - 3 * t2 + 1) + m0 * (span * (t3 - 2 * t2 + t)) +
                                                   p1 * (3 * t2 - 2 * t3) + m1 * (span * (t3 - t2)))});
      }
    }
    keys.push_back({times[k], as(values, (cubic ? 3 * k + 1 : k) * wide, wide, kind)});
  }
  return keys;
}

void read_weights(const GltfDocument& document, const Field& sampler, int node, Scene& scene) {
  for (Deformation& d : scene.deformations)
    if (d.node == node && !d.targets.empty()) {
      if (!d.keys.empty()) return note_once(scene.unsupported, "several animations of one node");
      d.keys = read_keys<std::valarray<double>>(document, sampler, d.targets.size(), 1);
    }
}

}  // namespace

NodeTransform node_transform(const Field& node) {
  const auto t = node["translation"].numbers({0, 0, 0}), q = node["rotation"].numbers({0, 0, 0, 1}),
             s = node["scale"].numbers({1, 1, 1});
  const Quaternion turn(q[3], q[0], q[1], q[2]);
  if (!(glm::length(turn) > 1e-6)) node["rotation"].fail("is no rotation");
  return {{t[0], t[1], t[2]}, {s[0], s[1], s[2]}, glm::normalize(turn)};
}

void read_motions(const GltfDocument& document, std::span<const int> placed, Scene& scene) {
  const Field animations = document.root()["animations"], nodes = document.root()["nodes"];
  std::map<int, Animation> moving;  // By node of the scene.
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const Field channels = animations[a]["channels"], samplers = animations[a]["samplers"];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const Field target = channels[c]["target"];
      if (!target["node"].there()) continue;
      const std::size_t at = target["node"].index(nodes.size());
      const Field sampler = samplers[channels[c]["sampler"].index(samplers.size())];
      const std::string path = target["path"].text();
      if (placed[at] < 0) continue;
      if (path == "weights") {
        read_weights(document, sampler, placed[at], scene);
        continue;
      }
      if (nodes[at]["matrix"].there()) target.fail("moves a node that has a matrix");
      Animation& motion = moving[placed[at]];
      const auto fill = [&](auto& keys) {
        using T = decltype(keys.front().value);
        if (!keys.empty()) return note_once(scene.unsupported, "several animations of one node");
        keys = read_keys<std::remove_reference_t<T>>(document, sampler, T::length(), T::length());
      };
      if (path == "translation")
        fill(motion.translations);
      else if (path == "rotation")
        fill(motion.rotations);
      else if (path == "scale")
        fill(motion.scales);
      else
        target["path"].fail("is '" + path + "', nothing that moves");
    }
  }
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto found = moving.find(placed[k]);
    if (placed[k] < 0 || found == moving.end()) continue;
    // What has no keys stays as the file says, whatever a matrix could be taken apart to.
    const NodeTransform rest = node_transform(nodes[k]);
    Animation& motion = found->second;
    motion.node = placed[k];
    if (motion.translations.empty()) motion.translations = {{0, rest.translation}};
    if (motion.rotations.empty()) motion.rotations = {{0, rest.rotation}};
    if (motion.scales.empty()) motion.scales = {{0, rest.scale}};
    scene.animations.push_back(std::move(motion));
  }
}

}  // namespace envmap
