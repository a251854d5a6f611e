#include "envmap/render/mirrors.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "envmap/render/shading.h"

namespace envmap {
namespace {

// A map in unchanged surroundings is drawn again as long as mirrors in it were: so often, then they have settled.
constexpr int settled = 8;

// Glass is seldom given a roughness of 0, and shows little of a small one.
constexpr float smooth_metal = 0.001F, smooth_glass = 0.2F;

bool is_smooth(const Material& m) { return m.roughness < (m.transmission > 0 ? smooth_glass : smooth_metal); }
bool is_mirror(const Material& m) { return (m.metallic > 0.999F || m.transmission > 0) && is_smooth(m); }

// Texels of a rough mirror's map: half of those of its prefiltered levels have no detail to lose.
constexpr int rough_size = 2 * glossy_size;

const Material& material_of(const Scene& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  return scene.materials[static_cast<std::size_t>(mesh.material)];
}

// What lies round a mirror stands still.
bool same_surroundings(const Scene& scene, int mirror, const Pose& a, const Pose& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t node = 0; node < a.size(); ++node)
    if (a[node] != b[node] && !lies_under(scene, static_cast<int>(node), mirror)) return false;
  return true;
}

// Radians between texels where they lie widest, times the size.
double spacing(Projection p) { return p == Projection::cube ? 2 : 4; }

// Radians beyond a direction that a lookup may read: two texels at a rim or an edge, and what mirror.glsl mixes there.
double margin(const MapTexture& map) { return 6.0 / map.size; }

// Z towards `axis`, X level.
Rotation looking_along(const Direction& axis) {
  const Direction up = std::abs(axis.y) < 0.999 ? Direction(0, 1, 0) : Direction(0, 0, 1);
  const Direction x = glm::normalize(glm::cross(up, axis));
  return {x, glm::cross(axis, x), axis};
}

}  // namespace

Mirror make_mirror(const Scene& scene, int node, Projection to) {
  Mirror mirror{.node = node, .to = to};
  for (const Instance& instance : instances(scene)) {
    if (!lies_under(scene, instance.node, node)) continue;
    const Material& m = material_of(scene, instance);
    if (m.transmission > 0) mirror.optics.ior = std::max(1.0F, m.ior);
    if (m.double_sided) mirror.optics.double_sided = true;
    if (!is_smooth(m)) mirror.rough = true;
  }
  if (mirror.rough) mirror.to = Projection::cube;
  return mirror;
}

std::vector<Mirror> find_mirrors(const Scene& scene, Projection to) {
  std::vector<Mirror> mirrors;
  for (const Instance& instance : instances(scene)) {
    const Material& m = material_of(scene, instance);
    if (!is_mirror(m)) continue;
    const bool known =
        std::ranges::any_of(mirrors, [&](const Mirror& other) { return lies_under(scene, instance.node, other.node); });
    if (!known) mirrors.push_back(make_mirror(scene, instance.node, to));
  }
  return mirrors;
}

Mirrors::Mirrors(const Scene& scene, std::vector<Mirror> mirrors)
    : scene_(scene), mirrors_(std::move(mirrors)), maps_(mirrors_.size()), drawn_(mirrors_.size()) {}

Mirrors::Wanted Mirrors::wanted(std::size_t k, const Shot& shot, const std::vector<Viewer>& viewers, double pixel) const {
  const Mirror& mirror = mirrors_[k];
  Wanted out{.finest = pi};
  for (const Viewer& viewer : viewers)
    for (const Instance& instance : instances(scene_)) {
      if (!lies_under(scene_, instance.node, mirror.node)) continue;
      const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(instance.mesh)];
      const Shown shown = shown_directions(viewer, mesh, shot.pose[static_cast<std::size_t>(instance.node)], mirror.optics);
      out.caps.insert(out.caps.end(), shown.caps.begin(), shown.caps.end());
      out.finest = std::min(out.finest, pixel * shown.widening);
      if (mirror.optics.refracts()) {
        // A lens reflects, too.
        const Shown reflected = shown_directions(viewer, mesh, shot.pose[static_cast<std::size_t>(instance.node)],
                                                 {0, mirror.optics.double_sided});
        out.caps.insert(out.caps.end(), reflected.caps.begin(), reflected.caps.end());
      }
    }
  return out;
}

unsigned Mirrors::needed_faces(std::size_t k, const std::vector<Cap>& caps) const {
  const MirrorMap& map = maps_[k];
  if (mirrors_[k].rough || mirrors_[k].to == Projection::sphere) return (1U << faces(mirrors_[k].to)) - 1;
  unsigned needed = 0;
  if (mirrors_[k].to == Projection::cube) {
    const auto reached = reached_faces(caps, map.axes, margin(*map.texture));
    for (unsigned face = 0; face < 6; ++face) needed |= reached[face] ? 1U << face : 0;
    return needed;
  }
  for (const Cap& cap : caps) {
    const double reach = cap.angle + margin(*map.texture), along = angle_between(cap.axis, map.axes[2]);
    if (along - reach <= pi / 2) needed |= 1;
    if (along + reach >= pi / 2) needed |= 2;
  }
  return needed;
}

// Size and axes of a map. Both stay as they are as long as they will do, so that a map can stay. @return whether the map
// must be drawn anew.
bool Mirrors::prepare(std::size_t k, const Shot& shot, const Wanted& want, const Viewer& viewer,
                      const MirrorOptions& options) {
  const Mirror& mirror = mirrors_[k];
  MirrorMap& map = maps_[k];
  Drawn& drawn = drawn_[k];
  const double texels = std::ceil(spacing(mirror.to) / std::max(want.finest, 1e-6) / 32) * 32;
  const int largest = mirror.rough ? std::min(rough_size, options.largest) : options.largest;
  const int size = options.size > 0 ? options.size : static_cast<int>(std::clamp(texels, 32.0, 1.0 * largest));
  const bool fits = map.texture && (options.size > 0 ? map.texture->size == size
                                                     : map.texture->size >= size && map.texture->size <= 2 * size);
  const bool moved = !fits || want.at != drawn.at || !same_surroundings(scene_, mirror.node, shot.pose, drawn.pose);
  if (!fits) map.texture.emplace(mirror.to, size);
  drawn.unchanged = moved ? 0 : drawn.unchanged + 1;
  if (mirror.rough || mirror.to == Projection::cube) return moved;
  if (mirror.to == Projection::sphere) {
    // Its singularity lies behind a mirror, where only the outline shows it; of a lens, before it.
    const Direction axis = glm::normalize(viewer.at - want.at) * (mirror.optics.refracts() ? -1.0 : 1.0);
    if (!moved && axis == map.axes[2]) return false;
    map.axes = looking_along(axis);
    return true;
  }
  const Cap all = enclosing(want.caps);
  const double room = pi / 2 - margin(*map.texture) - all.angle;
  if (!moved && (room <= 0 || angle_between(map.axes[2], all.axis) < room)) return false;
  map.axes = room > 0 ? looking_along(all.axis) : Rotation(1);
  return true;
}

void Mirrors::draw(std::size_t k, Renderer& renderer, const Shot& shot, const Direction& at,
                   const MirrorOptions& options, unsigned which) {
  MirrorMap& map = maps_[k];
  const Mirror& mirror = mirrors_[k];
  const Viewpoint from{.to = mirror.to,
                       .size = map.texture->size,
                       .at = at,
                       .axes = map.axes,
                       .near = options.near,
                       .far = options.far,
                       .without = mirror.node,
                       .which = which,
                       .cull = !options.all};
  Shot with_maps = shot;
  with_maps.mirrors = maps_;
  with_maps.look = {};
  renderer.draw(from, with_maps, options.method, *map.texture);
  if (!mirror.rough) return;
  const EnvironmentLight light = environment_light(read_back(*map.texture), std::min(glossy_size, map.texture->size));
  map.glossy = upload(&light);
}

void Mirrors::update(Renderer& renderer, const Shot& shot, const std::vector<Viewer>& viewers, double pixel,
                     const MirrorOptions& options, const std::function<void(const std::string&)>& tell) {
  // Who sees whom: first the picture, then mirrors that are seen there, as often as light goes on.
  std::vector<Wanted> want(mirrors_.size());
  for (std::size_t k = 0; k < want.size(); ++k) {
    want[k] = wanted(k, shot, viewers, pixel);
    want[k].at = centre_of(scene_, shot.pose, mirrors_[k].node);
  }
  for (int bounce = 0; bounce < options.bounces; ++bounce) {
    std::vector<Viewer> seen;
    for (std::size_t k = 0; k < want.size(); ++k)
      if (!want[k].caps.empty()) seen.push_back({want[k].at, {}, mirrors_[k].node});
    const std::vector<Wanted> before = want;
    for (std::size_t k = 0; k < want.size(); ++k) {
      std::vector<Viewer> others;
      std::ranges::copy_if(seen, std::back_inserter(others), [&](const Viewer& v) { return v.node != mirrors_[k].node; });
      const Wanted more = wanted(k, shot, others, pixel);
      want[k] = before[k];
      want[k].caps.insert(want[k].caps.end(), more.caps.begin(), more.caps.end());
    }
  }
  // Where maps see others before those are first drawn, once more: nobody has seen a frame before this one.
  const bool first = std::ranges::any_of(maps_, [](const MirrorMap& m) { return !m.texture; }) && maps_.size() > 1;
  std::vector<bool> anew(mirrors_.size());
  for (std::size_t k = 0; k < mirrors_.size(); ++k)
    if (!want[k].caps.empty()) anew[k] = prepare(k, shot, want[k], viewers.front(), options);
  for (int round = 0; round < options.bounces + (first ? 1 : 0); ++round)
    for (std::size_t k = 0; k < mirrors_.size(); ++k) {
      const std::string& name = scene_.nodes[static_cast<std::size_t>(mirrors_[k].node)].name;
      Drawn& drawn = drawn_[k];
      if (want[k].caps.empty()) {
        if (round == 0) tell(fmt::format("{}: not seen, not drawn", name));
        continue;
      }
      const unsigned every = (1U << faces(mirrors_[k].to)) - 1, needed = options.all ? every : needed_faces(k, want[k].caps);
      std::vector<int> versions;
      for (std::size_t other = 0; other < drawn_.size(); ++other)
        versions.push_back(other == k ? 0 : drawn_[other].version);
      const bool same =
          !anew[k] && (needed & ~drawn.faces) == 0 && (versions == drawn.versions || drawn.unchanged >= settled);
      if (same && !options.all) {
        tell(fmt::format("{}: its surroundings did not move, not drawn again", name));
        continue;
      }
      const auto start = std::chrono::steady_clock::now();
      draw(k, renderer, shot, want[k].at, options, needed);
      drawn.pose = shot.pose;
      drawn.at = want[k].at;
      drawn.faces = anew[k] ? needed : drawn.faces | needed;
      drawn.versions = versions;
      ++drawn.version;
      anew[k] = false;
      glFinish();
      tell(fmt::format("{}: {} of {}, {} of {} faces drawn in {:.1f} ms", name, envmap::name(mirrors_[k].to),
                       maps_[k].texture->size, std::popcount(needed), faces(mirrors_[k].to),
                       1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
    }
}

}  // namespace envmap
