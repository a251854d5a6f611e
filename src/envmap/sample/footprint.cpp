#include "envmap/sample/footprint.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// How a direction, turned into the source's frame already, moves there:
// through the camera by differences over a quarter of the way.
Direction brought_to_source(const Target& target, const Direction& at, const Direction& move) {
  if (!target.ball) return move;
  constexpr double step = 0.25;
  const auto seen = [&](double part) { return target.ball->seen_from_afar(glm::normalize(at + part * move)); };
  return (seen(step) - seen(-step)) / (2 * step);
}

// Where derivatives are found for a point: across the rim of a sphere map they would cancel.
Point2 within_rim(Projection to, int size, const Point2& at) {
  if (!on_disc(to)) return at;
  const double r = glm::length(2.0 * at - 1.0);
  return 0.5 + (at - 0.5) * std::min(1.0, std::max(0.1, 1 - 0.5 / size) / std::max(r, 1e-9));
}

}  // namespace

Derivative texel_derivative(Projection to, int size, int face, const Point2& at) {
  const double h = size, w = h * aspect(to);
  const Point2 inside = within_rim(to, size, at);
  const Derivative by_side = derivative(to, {face, inside.x, inside.y}, 0.25 / h);
  return {by_side.du / w, by_side.dv / h};
}

Jacobian jacobian(const Target& target, Projection source, int source_size, int face, const Point2& at) {
  const Derivative out = texel_derivative(target.to, target.size, face, at);
  Direction d = direction_at(target.to, face, within_rim(target.to, target.size, at));
  const Direction in_frame = target.to_source * d;
  target.bring_to_source({&d, 1});
  const Derivative in = derivative(source, locate(source, d), 0.25 / source_size);
  const Direction a = in.du / (1.0 * source_size * aspect(source)), b = in.dv / double(source_size);
  const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b), most = std::max(aa, bb);
  const double det = std::max(aa * bb - ab * ab, std::max(1e-6 * most * most, 1e-300));
  const auto moved = [&](const Direction& move) {
    const Direction m = brought_to_source(target, in_frame, target.to_source * move);
    const double ma = glm::dot(a, m), mb = glm::dot(b, m);
    return Point2(bb * ma - ab * mb, aa * mb - ab * ma) / det;
  };
  return {moved(out.du), moved(out.dv)};
}

Ellipse ellipse(const Jacobian& j) {
  const double aa = glm::dot(j.du, j.du), ab = glm::dot(j.du, j.dv), bb = glm::dot(j.dv, j.dv);
  const double middle = 0.5 * (aa + bb), swing = portable::hypot(0.5 * (aa - bb), ab);
  const double major = std::sqrt(middle + swing);
  // The product of the singular values is the determinant: their difference would cancel where one is small.
  const double minor = std::abs(j.du.x * j.dv.y - j.du.y * j.dv.x) / std::max(major, 1e-300);
  const double angle = 0.5 * portable::atan2(2 * ab, aa - bb);
  return {major, minor, {portable::cos(angle), portable::sin(angle)}};
}

}  // namespace envmap
