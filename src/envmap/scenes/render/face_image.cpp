#include "envmap/scenes/render/face_image.h"

#include "envmap/projection/visit.h"

namespace envmap {

double reach(Projection p) {
  if (!filled_disc(p)) return pi;
  return visit(p, [](auto q) {
    using P = decltype(q);
    return angle_between(P::template direction<double>(0, 0.5, 0.5), P::template direction<double>(0, 1.0, 1.0));
  });
}

Rotation map_to_face(Projection p, int face) {
  const Derivative moves = derivative(p, {face, 0.5, 0.5}, 1e-4);
  const Direction middle = visit(p, [&](auto q) { return decltype(q)::template direction<double>(face, 0.5, 0.5); });
  const Direction right = glm::normalize(moves.du), up = -glm::normalize(moves.dv);
  // The axes of all projections are those of the map, which rounding finds again to the last bit.
  if (image_shape(p) == ImageShape::band) return glm::transpose(Rotation(round(middle), round(-right), round(up)));
  return glm::transpose(Rotation(round(right), round(up), round(middle)));
}

}  // namespace envmap
