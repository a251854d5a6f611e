#include "envmap/io/limit.h"

namespace envmap {

Limited::Limited(const Rows& rows, double limit, bool weigh)
    : limit_(limit),
      weigh_(weigh),
      limited_(rows),
      excess_(static_cast<std::size_t>(faces(rows.projection)) * static_cast<std::size_t>(rows.size)) {
  limited_.fill = [this, &rows](int face, int row, std::span<Colour> out) {
    rows.fill(face, row, out);
    excess_[static_cast<std::size_t>(face) * static_cast<std::size_t>(rows.size) + static_cast<std::size_t>(row)] =
        cut(row, out);
  };
}

Excess Limited::total() const {
  Excess sum;
  for (const Excess& e : excess_) {
    sum.count += e.count;
    sum.lost += e.lost;
    sum.flux += e.flux;
  }
  return sum;
}

Excess Limited::cut(int row, std::span<Colour> out) const {
  Excess e;
  const auto limit = static_cast<float>(limit_);
  std::vector<double> w;
  if (weigh_) {
    w.resize(out.size());
    solid_angles(limited_.projection, limited_.size, row, w);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Colour c = out[i], over = glm::max(c - limit, Colour(0));
    e.count += over.x > 0 || over.y > 0 || over.z > 0;
    out[i] = glm::min(c, Colour(limit));
    if (weigh_) e.lost += w[i] * (over.x + over.y + over.z), e.flux += w[i] * (c.x + c.y + c.z);
  }
  return e;
}

}  // namespace envmap
