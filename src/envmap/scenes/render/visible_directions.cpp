#include "envmap/scenes/render/visible_directions.h"

#include <algorithm>
#include <cmath>

#include "envmap/projection/visit.h"

namespace envmap {
namespace {

constexpr int deepest = 6;
// From the middle of a face of the cube to its corners: acos(1/sqrt 3), rounded up.
constexpr double corner_angle = 0.95532;

struct Corner {
  Direction position, normal;
};
using Facet = std::array<Corner, 3>;

Corner halfway(const Corner& a, const Corner& b) {
  return {(a.position + b.position) * 0.5, (a.normal + b.normal) * 0.5};
}

// The cap round three directions about their mean; every direction where they may surround half a sphere.
DirectionCone cap_of(const std::array<Direction, 3>& v) {
  const Direction sum = v[0] + v[1] + v[2];
  if (glm::length(sum) < 1e-6) return {v[0], pi};
  DirectionCone cap{glm::normalize(sum), 0};
  for (const Direction& d : v) cap.angle = std::max(cap.angle, angle_between(cap.axis, d));
  if (cap.angle >= pi / 2) cap.angle = pi;
  return cap;
}

Direction unit_or_z(const Direction& v) { return unit(v, Direction(0, 0, 1)); }

// How much directions turn for what the ray does, at least, and how large the part is that does so.
struct Widening {
  double least, solid_angle;
};

// What all but a tenth of a mirror reaches.
double usual(std::vector<Widening> all) {
  std::ranges::sort(all, {}, &Widening::least);
  double whole = 0, below = 0;
  for (const Widening& w : all) whole += w.solid_angle;
  for (const Widening& w : all)
    if ((below += w.solid_angle) >= 0.1 * whole) return w.least;
  return std::numeric_limits<double>::infinity();
}

struct Search {
  const Viewer& viewer;
  const MirrorOptics& optics;
  const std::optional<Direction>& middle;
  double fineness;
  std::vector<DirectionCone>& caps;
  std::vector<Widening>& widenings;

  [[nodiscard]] bool out_of_sight(const Facet& f) const {
    return std::ranges::any_of(viewer.planes, [&](const auto& plane) {
      return std::ranges::all_of(f,
                                 [&](const Corner& c) { return glm::dot(Direction(plane), c.position) + plane.w < 0; });
    });
  }

  // Where rays of these directions go that start at a part of the mesh.
  void add_rays(const Facet& f, const DirectionCone& along) {
    if (!middle) return caps.push_back(along);
    if (optics.refracts()) {  // From one side of a lens to the other: all round.
      if (caps.empty()) caps.push_back({along.axis, pi});
      return;
    }
    const auto from = [&](int i) { return unit_or_z(f[i].position - *middle); };
    const DirectionCone start = cap_of({from(0), from(1), from(2)});
    const double arc = angle_between(start.axis, along.axis), widest = std::max(start.angle, along.angle);
    if (arc + widest > 3) return caps.push_back({along.axis, pi});
    // Between caps of this size two arcs part by no more than 1 / cos(arc / 2) times as much as at their ends.
    const double radius = widest / std::cos(0.5 * arc);
    const int pieces = 1 + int(arc / (2 * fineness));
    for (int k = 0; k < pieces; ++k) {
      const double part = (k + 0.5) / pieces;
      const Direction axis = std::sin((1 - part) * arc) * start.axis + std::sin(part * arc) * along.axis;
      caps.push_back({arc > 1e-6 ? unit_or_z(axis) : along.axis, std::min(radius + 0.5 * arc / pieces, pi)});
    }
  }

  void add(const Facet& f, int depth) {
    if (out_of_sight(f)) return;
    const auto rays = [&](int i) { return unit_or_z(f[i].position - viewer.at); };
    const auto normals = [&](int i) { return unit_or_z(f[i].normal); };
    const DirectionCone view = cap_of({rays(0), rays(1), rays(2)}),
                        normal = cap_of({normals(0), normals(1), normals(2)});
    const double angle = view.angle + 2 * normal.angle;
    if (angle <= fineness || depth == deepest) {
      Widening w{std::numeric_limits<double>::infinity(),
                 0.5 * glm::length(glm::cross(rays(1) - rays(0), rays(2) - rays(0)))};
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const Direction from = optics.turned(rays(i), normals(i)), to = optics.turned(rays(j), normals(j));
        if (const double turn = angle_between(rays(i), rays(j)); turn > 1e-9)
          w.least = std::min(w.least, angle_between(from, to) / turn);
      }
      widenings.push_back(w);
      add_rays(f, {optics.turned(view.axis, normal.axis), std::min(angle, pi)});
      // Where some of the rays graze the surface, a normal may turn either way to face the viewer.
      if (optics.refracts() && std::abs(glm::dot(view.axis, normal.axis)) < std::sin(std::min(angle, pi / 2))) {
        const double facing = glm::dot(view.axis, normal.axis) > 0 ? -1 : 1;
        add_rays(f, {unit_or_z(glm::refract(view.axis, -facing * normal.axis, 1 / optics.ior)), std::min(angle, pi)});
      }
      return;
    }
    const Corner a = halfway(f[1], f[2]), b = halfway(f[2], f[0]), c = halfway(f[0], f[1]);
    for (const Facet& part : {Facet{f[0], c, b}, Facet{c, f[1], a}, Facet{b, a, f[2]}, Facet{a, b, c}})
      add(part, depth + 1);
  }
};

}  // namespace

Direction MirrorOptics::turned(const Direction& view, const Direction& normal) const {
  if (!refracts()) return glm::reflect(view, normal);
  return unit_or_z(glm::refract(view, glm::faceforward(normal, view, normal), 1 / ior));
}

VisibleCone reflection_bounds(const Viewer& viewer, const Mesh& mesh, const Matrix& world, const MirrorOptics& optics,
                              const std::optional<Direction>& middle, double fineness) {
  const Rotation turn(world), normals = glm::determinant(turn) != 0 ? glm::transpose(glm::inverse(turn)) : turn;
  const double handed = glm::determinant(turn) < 0 ? -1 : 1;  // A mirrored node's triangles are wound the other way.
  const auto corner = [&](std::uint32_t index) {
    return Corner{Direction(world * glm::vec<4, double, glm::highp>(mesh.positions[index], 1)),
                  unit_or_z(normals * Direction(mesh.normals[index]))};
  };
  VisibleCone shown;
  std::vector<Widening> widenings;
  Search search{viewer, optics, middle, fineness, shown.caps, widenings};
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Facet f{corner(mesh.indices[i]), corner(mesh.indices[i + 1]), corner(mesh.indices[i + 2])};
    const Direction facing = glm::cross(f[1].position - f[0].position, f[2].position - f[0].position) * handed;
    if (!optics.double_sided && glm::dot(facing, viewer.at - f[0].position) <= 0) continue;
    search.add(f, 0);
  }
  for (const Widening& w : widenings) shown.solid_angle += w.solid_angle;
  shown.widening = usual(std::move(widenings));
  return shown;
}

std::optional<Direction> flat_normal(const Mesh& mesh, const Matrix& world) {
  if (mesh.indices.empty()) return {};
  const Direction normal(mesh.normals[mesh.indices.front()]), place(mesh.positions[mesh.indices.front()]);
  double size = 0, off = 0;
  for (const std::uint32_t k : mesh.indices) {
    const Direction way = Direction(mesh.positions[k]) - place;
    size = std::max(size, glm::length(way));
    off = std::max(off, std::abs(glm::dot(way, normal)));
    // Floats are no unit vectors to the last digit.
    if (glm::length(Direction(mesh.normals[k]) - normal) > 1e-5) return {};
  }
  if (off > 1e-5 * size) return {};
  const Rotation turn(world);
  return unit_or_z(cofactors(turn) * normal * (glm::determinant(turn) < 0 ? -1.0 : 1.0));
}

std::array<bool, 6> reached_faces(std::span<const DirectionCone> caps, const Rotation& axes, double margin) {
  std::array<bool, 6> reached{};
  const Rotation to_map = glm::transpose(axes);
  for (const DirectionCone& cap : caps) {
    const double angle = cap.angle + margin;
    const double reach = angle < pi / 2 ? std::sin(angle) : 2;
    const Direction axis = to_map * cap.axis;
    for (int face = 0; face < 6; ++face) {
      if (angle_between(axis, Cube::direction(face, 0.5, 0.5)) > angle + corner_angle) continue;
      // A face is what lies on the inner side of four planes through the point, each at 45 degrees between two axes.
      const int along = face / 2;
      const double forward = face % 2 == 0 ? axis[along] : -axis[along];
      const double side = std::max(std::abs(axis[(along + 1) % 3]), std::abs(axis[(along + 2) % 3]));
      if ((forward - side) / std::numbers::sqrt2 >= -reach) reached[face] = true;
    }
  }
  return reached;
}

DirectionCone enclosing(std::span<const DirectionCone> caps) {
  Direction sum(0);
  for (const DirectionCone& cap : caps) sum += cap.axis;
  struct Bounded {
    Direction axis;
    double cosine, sine;
  };
  std::vector<Bounded> all;
  for (const DirectionCone& cap : caps) all.push_back({cap.axis, std::cos(cap.angle), std::sin(cap.angle)});
  // The cosine of how far the widest reaches from an axis, -1 where it reaches all round: angles by atan2 took longer
  // than drawing.
  const auto widest = [&](const Direction& axis) {
    const Bounded* far = &all.front();
    double least = 2;
    for (const Bounded& cap : all) {
      const double along = glm::dot(axis, cap.axis);
      const double cosine =
          along < -cap.cosine ? -1 : along * cap.cosine - std::sqrt(std::max(0.0, 1 - along * along)) * cap.sine;
      if (cosine < least) least = cosine, far = &cap;
    }
    return std::pair(least, far);
  };
  DirectionCone best{unit_or_z(sum), pi};
  double highest = -1;
  Direction centre = best.axis;
  for (int step = 2; step < 64; ++step) {
    const auto [cosine, far] = widest(centre);
    if (cosine > highest) best.axis = centre, highest = cosine;
    centre = unit_or_z(centre + (far->axis - centre) / double(step));
  }
  best.angle = 0;
  for (const DirectionCone& cap : caps)
    best.angle = std::max(best.angle, angle_between(best.axis, cap.axis) + cap.angle);
  best.angle = std::min(best.angle, pi);
  return best;
}

}  // namespace envmap
