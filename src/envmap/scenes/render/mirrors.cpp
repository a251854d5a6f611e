#include "envmap/scenes/render/mirrors.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/scenes/render/shading/shading.h"

namespace envmap {
namespace {

bool is_mirror(const Material& m) { return (m.metallic > 0.999F || m.transmission > 0) && is_smooth(m); }

// Texels of a rough mirror's map: half of those of its prefiltered levels have no detail to lose.
constexpr int rough_size = 2 * glossy_size;

const Material& material_of(const SceneGraph& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  return scene.materials[mesh.material];
}

// Of a flat mirror's map that is looked up in other mirrors alone.
constexpr int flat_size = 256;

bool is_metal(const SceneGraph& scene, int node) {
  return std::ranges::all_of(instances(scene), [&](const Instance& instance) {
    return !lies_under(scene, instance.node, node) || material_of(scene, instance).metallic > 0.999F;
  });
}

// What a mirror shows stands still. Where lights shine, the mirror's own nodes count, too: they may hold lights, and
// they cast shadows.
bool same_surroundings(const FrameState& shot, int mirror, const Pose& before) {
  if (shot.pose.size() != before.size()) return false;
  const bool is_lit = !shot.scene.lights.empty() || !shot.distant.empty();
  for (std::size_t node = 0; node < before.size(); ++node)
    if (shot.pose[node] != before[node] && (is_lit || !lies_under(shot.scene, int(node), mirror))) return false;
  return true;
}

// Radians between texels where they lie widest, times the size.
double spacing(Projection p) { return p == Projection::cube ? 2 : 4; }

// Radians beyond a direction that a lookup may read: two texels at a rim or an edge, and what mirror.glsl mixes there.
double margin(int size) { return 6.0 / size; }

unsigned all_faces(Projection p) { return (1U << faces(p)) - 1; }

// More texels than this many a pixel that looks them up are not drawn, however fine those could show them: a bottle a
// few pixels wide does not get the map of a flat mirror that fills the picture.
constexpr double texels_a_pixel = 64;

// Down to 4 texels.
int level_count(int size) { return std::max(1, int(std::bit_width(unsigned(size))) - 2); }

// As fine as the pixels are, or as they can afford. @param step radians between texels.
int fitting_size(const Mirror& mirror, double step, double pixels) {
  const double fine = spacing(mirror.to) / std::max(step, 1e-6);
  const double affordable = std::sqrt(texels_a_pixel * pixels / faces(mirror.to));
  return int(std::clamp(std::ceil(std::min(fine, affordable) / 32) * 32, 32.0, 8192.0));
}

// What can be told apart in a picture: 1/255 of white, or of what is brighter.
bool differs(const EnvironmentMap& a, const EnvironmentMap& b) {
  const auto differ = [](const Colour& x, const Colour& y) {
    const Colour off = glm::abs(x - y) - glm::max(Colour(1), glm::abs(y)) / 255.0F;
    return std::max(off.x, std::max(off.y, off.z)) > 0;
  };
  const auto rows = map_rows<int>(a.base().height(), [&](int row) {
    for (int face = 0; face < a.base().faces(); ++face)
      for (int i = 0; i < a.base().width(); ++i)
        if (differ(*a.base().texel(face, i, row), *b.base().texel(face, i, row))) return 1;
    return 0;
  });
  return std::ranges::find(rows, 1) != rows.end();
}

}  // namespace

Mirror make_mirror(const SceneGraph& scene, int node, Projection to) {
  Mirror mirror{.node = node, .to = to};
  for (const Instance& instance : instances(scene)) {
    if (!lies_under(scene, instance.node, node)) continue;
    const Material& m = material_of(scene, instance);
    if (m.transmission > 0) mirror.optics.ior = m.solid ? std::max(1.0F, m.ior) : 1;
    if (m.double_sided) mirror.optics.double_sided = true;
    if (!is_smooth(m)) mirror.rough = true;
  }
  if (mirror.rough) mirror.to = Projection::cube;
  return mirror;
}

std::vector<Mirror> find_mirrors(const SceneGraph& scene, Projection to) {
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

std::vector<int> nodes_of(const std::vector<Mirror>& mirrors) {
  std::vector<int> nodes;
  for (const Mirror& mirror : mirrors) nodes.push_back(mirror.node);
  return nodes;
}

Mirrors::Mirrors(const SceneGraph& scene, std::vector<Mirror> mirrors)
    : scene_(scene), mirrors_(std::move(mirrors)), maps_(mirrors_.size()), drawn_(mirrors_.size()) {}

void Mirrors::add_wanted(std::size_t k, const FrameState& shot, const Viewer& viewer, Wanted& want) const {
  const Mirror& mirror = mirrors_[k];
  std::optional<Direction> middle;
  if (shot.look.lookup == MirrorLookup::distance && !want.front) middle = want.at;
  for (const Instance& instance : instances(scene_)) {
    if (!lies_under(scene_, instance.node, mirror.node)) continue;
    const Mesh& mesh = scene_.meshes[instance.mesh];
    const Matrix& world = shot.pose[instance.node];
    const auto add = [&](const MirrorOptics& optics) {
      const VisibleCone shown = reflection_bounds(viewer, mesh, world, optics, middle);
      want.caps.insert(want.caps.end(), shown.caps.begin(), shown.caps.end());
      return shown;
    };
    const VisibleCone shown = add(mirror.optics);
    if (viewer.pixel > 0) {
      want.spacing = std::min(want.spacing, viewer.pixel * shown.widening);
      want.pixels += shown.solid_angle / (viewer.pixel * viewer.pixel);
    }
    if (is_bumpy(material_of(scene_, instance)) && !shown.caps.empty())
      want.caps.push_back({Direction(0, 0, 1), pi});                                // Where a normal map may send rays.
    if (mirror.optics.refracts() && !middle) add({0, mirror.optics.double_sided});  // A lens reflects, too.
  }
}

std::optional<Direction> Mirrors::normal_of(const Mirror& mirror, const FrameState& shot) const {
  std::optional<Direction> normal;
  if (mirror.optics.refracts()) return {};
  for (const Instance& instance : instances(scene_)) {
    if (!lies_under(scene_, instance.node, mirror.node)) continue;
    if (normal || is_bumpy(material_of(scene_, instance))) return {};
    normal = flat_normal(scene_.meshes[instance.mesh], shot.pose[instance.node]);
    if (!normal) return {};
  }
  return normal;
}

void Mirrors::set_flat(std::size_t k, const FrameState& shot, const Wanted& want) {
  MirrorMap& map = maps_[k];
  map.flat.reset(), map.radius = 0, map.centre = want.at;
  if (!want.normal || mirrors_[k].rough) return;
  map.double_sided = mirrors_[k].optics.double_sided, map.metal = is_metal(scene_, mirrors_[k].node);
  for (const Instance& instance : instances(scene_)) {
    if (!lies_under(scene_, instance.node, mirrors_[k].node)) continue;
    for (const glm::vec3& p : scene_.meshes[instance.mesh].positions) {
      const Direction place(shot.pose[instance.node] * Plane(p, 1));
      map.flat = Plane(*want.normal, -glm::dot(*want.normal, place));
      map.radius = std::max(map.radius, glm::length(place - map.centre));
    }
  }
}

// First what the viewers see, then what is seen in mirrors that are seen, and so on. Pictures say how large maps are;
// where a mirror is in none of them, the first map does that it is seen in.
std::vector<Mirrors::Wanted> Mirrors::wanted(const FrameState& shot, const std::vector<Viewer>& viewers) const {
  std::vector<Wanted> want(mirrors_.size());
  for (std::size_t k = 0; k < want.size(); ++k) {
    want[k].at = centre_of(scene_, shot.pose, mirrors_[k].node);
    if (shot.look.lookup == MirrorLookup::distance) want[k].normal = normal_of(mirrors_[k], shot);
    if (!mirrors_[k].optics.double_sided) want[k].front = want[k].normal;
    for (const Viewer& viewer : viewers) add_wanted(k, shot, viewer, want[k]);
  }
  std::vector<bool> looked_from(want.size());
  for (std::size_t from = 0; from < want.size();) {
    if (looked_from[from] || want[from].caps.empty()) {
      ++from;
      continue;
    }
    looked_from[from] = true;
    const double pixel =
        spacing(mirrors_[from].to) / fitting_size(mirrors_[from], want[from].spacing, want[from].pixels);
    for (std::size_t k = 0; k < want.size(); ++k)
      if (k != from)
        add_wanted(k, shot,
                   {.at = want[from].at, .node = mirrors_[from].node, .pixel = want[k].caps.empty() ? pixel : 0},
                   want[k]);
    from = 0;
  }
  return want;
}

// Size and axes stay as they are as long as they will do, so that the map can stay.
Mirrors::Plan Mirrors::plan(std::size_t k, const FrameState& shot, const Wanted& want, const Viewer& viewer,
                            const MirrorOptions& options) const {
  const Mirror& mirror = mirrors_[k];
  const MirrorMap& map = maps_[k];
  const Drawn& drawn = drawn_[k];
  // Pictures show what lies in it otherwise: draw_picture().
  const bool in_maps_only = want.normal && !viewer.planes.empty();
  const int most = mirror.rough   ? rough_size
                   : in_maps_only ? flat_size
                                  : options.largest,
            largest = std::min(most, options.largest);
  const int size = options.size > 0 ? options.size : std::min(fitting_size(mirror, want.spacing, want.pixels), largest);
  const bool fits = map.texture && (options.size > 0 ? map.texture->size == size
                                                     : map.texture->size >= size && map.texture->size <= 2 * size);
  const bool moved = !fits || options.moved || want.at != drawn.at || shot.look.lookup != drawn.lookup ||
                     !same_surroundings(shot, mirror.node, drawn.pose);
  Plan plan{.size = fits ? map.texture->size : size, .axes = map.axes, .anew = moved};
  if (mirror.rough || mirror.to == Projection::cube) return plan;
  if (mirror.to == Projection::sphere) {
    // Its singularity lies behind a mirror, where only the outline shows it; of a lens, before it.
    const Direction back = viewer.at == want.at ? Direction(0, 0, 1) : glm::normalize(viewer.at - want.at);
    plan.axes = upright_about(back * (mirror.optics.refracts() ? -1.0 : 1.0));
  } else if (want.front) {
    plan.axes = upright_about(*want.front);
  } else {
    const DirectionCone all = enclosing(want.caps);
    const double room = pi / 2 - margin(plan.size) - all.angle;
    if (moved || (room > 0 && angle_between(map.axes[2], all.axis) >= room))
      plan.axes = room > 0 ? upright_about(all.axis) : Rotation(1);
  }
  if (plan.axes != map.axes) plan.anew = true;
  return plan;
}

unsigned Mirrors::needed_faces(std::size_t k, const Wanted& want, const Plan& plan) const {
  const Mirror& mirror = mirrors_[k];
  if (mirror.rough || mirror.to == Projection::sphere) return all_faces(mirror.to);
  if (want.front && mirror.to == Projection::paraboloid) return 1;
  // Rays from a flat mirror may meet anything before it.
  const std::vector<DirectionCone> before(1, {want.front.value_or(Direction(0)), pi / 2 - margin(plan.size)});
  const std::vector<DirectionCone>& caps = want.front ? before : want.caps;
  unsigned needed = 0;
  if (mirror.to == Projection::cube) {
    const auto reached = reached_faces(caps, plan.axes, margin(plan.size));
    for (unsigned face = 0; face < 6; ++face) needed |= reached[face] ? 1U << face : 0;
    return needed;
  }
  for (const DirectionCone& cap : caps) {
    const double reach = cap.angle + margin(plan.size), along = angle_between(cap.axis, plan.axes[2]);
    if (along - reach <= pi / 2) needed |= 1;
    if (along + reach >= pi / 2) needed |= 2;
  }
  return needed;
}

// A map of another size or turned otherwise takes the place of the old one when it is drawn: until then, other mirrors
// look that up. Faces that nobody needs show the environment.
void Mirrors::draw(std::size_t k, Renderer& renderer, const FrameState& shot, const Direction& at, const Plan& plan,
                   unsigned needed, const MirrorOptions& options) {
  MirrorMap& map = maps_[k];
  const Mirror& mirror = mirrors_[k];
  Viewpoint from{.to = mirror.to,
                 .size = plan.size,
                 .at = at,
                 .axes = plan.axes,
                 .near = options.near,
                 .far = options.far,
                 .without = mirror.node,
                 .which = needed,
                 .cull = !options.all,
                 .show_ambient = true,
                 .mean_background = true};
  FrameState with_maps = shot;
  with_maps.mirrors = maps_;
  with_maps.look = {.lookup = shot.look.lookup == MirrorLookup::vertex ? MirrorLookup::direction : shot.look.lookup,
                    .images = true};
  const bool by_distance = with_maps.look.lookup == MirrorLookup::distance;
  std::optional<MapTexture> other;
  if (!map.texture || map.texture->size != plan.size || map.axes != plan.axes || drawn_[k].lookup != shot.look.lookup)
    other.emplace(mirror.to, plan.size, level_count(plan.size));
  MapTexture& to = other ? *other : *map.texture;
  const unsigned stale = other ? all_faces(mirror.to) : plan.anew ? drawn_[k].faces : 0;
  renderer.draw(from, with_maps, DrawMethod::exact, to);
  from.which = stale & ~needed;
  renderer.draw_background(from, with_maps, to);
  renderer.make_levels(to, stale | needed, by_distance);
  if (other) map.texture = std::move(other);
  map.axes = plan.axes;
  map.at = at;
  EnvironmentMap seen = read_back(*map.texture);
  Drawn& drawn = drawn_[k];
  if (!drawn.seen || drawn.seen->base().height() != plan.size || plan.anew || differs(seen, *drawn.seen))
    ++drawn.version;
  drawn.seen = std::move(seen);
  if (!mirror.rough) return;
  map.glossy = upload(environment_light(*drawn.seen, glossy_roughnesses(scene_, mirror.node),
                                        std::min(glossy_size, plan.size), plan.size));
}

MirrorUpdates Mirrors::update(Renderer& renderer, const FrameState& shot, const std::vector<Viewer>& viewers,
                              const MirrorOptions& options) {
  using enum MapUpdate::Outcome;
  MirrorUpdates updates;
  const std::vector<Wanted> want = wanted(shot, viewers);
  std::vector<Plan> plans(want.size());
  std::vector<unsigned> needed(want.size());
  for (std::size_t k = 0; k < want.size(); ++k) {
    set_flat(k, shot, want[k]);
    if (want[k].caps.empty()) {
      updates.maps.push_back({int(k), unseen});
      continue;
    }
    plans[k] = plan(k, shot, want[k], viewers.front(), options);
    needed[k] = options.all ? all_faces(mirrors_[k].to) : needed_faces(k, want[k], plans[k]);
  }
  bool changing = true;
  for (int round = 0; changing && round < options.bounces.value_or(max_rounds); ++round) {
    changing = false;
    for (std::size_t k = 0; k < want.size(); ++k) {
      if (want[k].caps.empty()) continue;
      Drawn& last = drawn_[k];
      std::vector<int> versions;
      for (std::size_t other = 0; other < drawn_.size(); ++other)
        versions.push_back(other == k ? 0 : drawn_[other].version);
      if (!plans[k].anew && (needed[k] & ~last.faces) == 0 && versions == last.versions &&
          (!options.all || round > 0)) {
        if (round == 0) updates.maps.push_back({int(k), unchanged});
        continue;
      }
      const auto start = std::chrono::steady_clock::now();
      draw(k, renderer, shot, want[k].at, plans[k], needed[k], options);
      last.pose = shot.pose;
      last.at = want[k].at;
      last.lookup = shot.look.lookup;
      last.faces = plans[k].anew ? needed[k] : last.faces | needed[k];
      last.versions = versions;
      plans[k].anew = false;
      changing = true;
      updates.maps.push_back({int(k), drawn, plans[k].size, std::popcount(needed[k]),
                              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
    }
  }
  updates.settled = !changing || options.bounces || maps_.size() < 2;
  return updates;
}

}  // namespace envmap
