#include "envmap/operate/photo_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

// A circle that was found is right to half a pixel, and outlines are blurred over one.
constexpr double inset = 0.5;

// The pixels inside a circle, and beyond it the colours of the last ones towards its centre.
class Disc {
 public:
  Disc(const Level& photo, const Circle& circle) : photo_(photo), circle_(circle), kept_(circle.radius - inset) {}

  // Catmull-Rom interpolation, clamped to the four nearest pixels.
  [[nodiscard]] Colour at(const Point2& place) const {
    const double x = place.x - 0.5, y = place.y - 0.5, left = std::floor(x), top = std::floor(y);
    const std::array<double, 4> wx = catmull_rom<double>(x - left), wy = catmull_rom<double>(y - top);
    Flux sum(0);
    Colour least(std::numeric_limits<float>::max()), most(-least);
    for (int b = 0; b < 4; ++b)
      for (int a = 0; a < 4; ++a) {
        const Colour c = pixel(int(left) + a - 1, int(top) + b - 1);
        sum += wx[std::size_t(a)] * wy[std::size_t(b)] * Flux(c);
        if (a < 1 || a > 2 || b < 1 || b > 2) continue;
        least = glm::min(least, c), most = glm::max(most, c);
      }
    return glm::clamp(Colour(sum), least, most);
  }

 private:
  [[nodiscard]] Colour pixel(int i, int j) const {
    double x = i + 0.5 - circle_.x, y = j + 0.5 - circle_.y;
    const double corner_x = std::abs(x) + 0.5, corner_y = std::abs(y) + 0.5;
    if (corner_x * corner_x + corner_y * corner_y > kept_ * kept_) {
      // So far inside that the pixel there is inside as a whole: its farthest corner is sqrt(2) away at most.
      const double k = std::min(1.0, (kept_ - std::numbers::sqrt2) / std::sqrt(x * x + y * y));
      i = int(std::floor(circle_.x + k * x)), j = int(std::floor(circle_.y + k * y));
    }
    return *photo_.texel(0, std::clamp(i, 0, photo_.width() - 1), std::clamp(j, 0, photo_.height() - 1));
  }

  const Level& photo_;
  Circle circle_;
  double kept_;
};

Level square_level(Projection projection, double size, const PhotoMapOptions& options) {
  if (size > limits::size.most || size * size > double(options.max_pixels))
    throw InputError(fmt::format("the whole sphere takes {:.0f}x{:.0f} texels at the photo's resolution", size, size),
                     Remedy::allow_pixels);
  const std::size_t bytes = std::size_t(size * size) * sizeof(Colour);
  return {projection, int(size), 0, bytes > options.max_memory / 2 ? options.max_memory : 0};
}

EnvironmentMap map_of(Level&& level) {
  EnvironmentMap map;
  map.levels.push_back(std::move(level));
  return map;
}

void check(const Circle& circle) {
  if (!(circle.radius >= least_radius))
    throw InputError(
        fmt::format("a circle of radius {:g} is too small: it takes {} pixels", circle.radius, least_radius));
}

// What two photos back to back show at places of an angular map: (s, t) with the rim at 1.
struct Weights {
  double front, back;
};

class Pair {
 public:
  Pair(const Fisheye& lens, const std::optional<Fisheye>& back)
      : lens_(lens), back_lens_(back.value_or(lens)), back_(back) {}

  // Where the photos show what the map has at (s,t), r from its middle.
  [[nodiscard]] Point2 front(double s, double t, double r) const {
    const double k = r > 0 ? lens_.radius(pi * r) / r : 0;
    return {lens_.circle.x + k * s, lens_.circle.y - k * t};
  }
  [[nodiscard]] Point2 back(double s, double t, double r) const {
    const double k = r > 0 ? back_lens_.radius(pi * std::max(0.0, 1 - r)) / r : 0;
    return {back_lens_.circle.x - k * s, back_lens_.circle.y - k * t};
  }

  [[nodiscard]] Weights at(double s, double t) const {
    const double r = std::sqrt(s * s + t * t);
    if (r > 1) return {0, 0};
    // Radians from the circle, where the photo shows the place.
    const double f = lens_.depth(front(s, t, r)) > 0 ? lens_.half - pi * r : 0;
    const double b = back_ && back_lens_.depth(back(s, t, r)) > 0 ? back_lens_.half - pi * (1 - r) : 0;
    return f > 0 || b > 0 ? Weights{std::max(0.0, f) / (std::max(0.0, f) + std::max(0.0, b)),
                                    std::max(0.0, b) / (std::max(0.0, f) + std::max(0.0, b))}
                          : Weights{0, 0};
  }

  // The mean over a texel, whose middle is (s,t) and whose width is `step`. Only an edge takes more than one look.
  [[nodiscard]] Weights over_texel(double s, double t, double step) const {
    const double r = std::sqrt(s * s + t * t);
    if (r > 1 + step) return {0, 0};
    const bool on_edge = std::abs(lens_.depth(front(s, t, r))) < 2 ||
                         (back_ && std::abs(back_lens_.depth(back(s, t, r))) < 2) || r > 1 - step;
    if (!on_edge) return at(s, t);
    constexpr int looks = 4;
    Weights sum{0, 0};
    int inside = 0;
    for (int b = 0; b < looks; ++b)
      for (int a = 0; a < looks; ++a) {
        const double x = s + step * ((a + 0.5) / looks - 0.5), y = t + step * ((b + 0.5) / looks - 0.5);
        if (x * x + y * y > 1) continue;
        const Weights w = at(x, y);
        sum.front += w.front, sum.back += w.back, ++inside;
      }
    return inside > 0 ? Weights{sum.front / inside, sum.back / inside} : Weights{0, 0};
  }

 private:
  Fisheye lens_, back_lens_;
  bool back_;
};

}  // namespace

EnvironmentMap ball_map(const Level& photo, const Circle& ball, const PhotoMapOptions& options) {
  check(ball);
  const double beyond = std::max({ball.radius - ball.x, ball.radius - ball.y, ball.x + ball.radius - photo.width(),
                                  ball.y + ball.radius - photo.height()});
  if (!(beyond <= 1))
    throw InputError(
        fmt::format("the ball's circle (middle {:.1f},{:.1f}, radius {:.1f}) reaches {:.1f} pixels beyond "
                    "the picture of {}x{}: the ball must be in it as a whole",
                    ball.x, ball.y, ball.radius, beyond, photo.width(), photo.height()));
  constexpr double rounding = 1e-6;
  Level level = square_level(Projection::sphere, std::ceil(2 * ball.radius - rounding), options);
  const Disc disc(photo, ball);
  const int size = level.height();
  const double scale = 2 * ball.radius / size;
  for_each_row(1, size, options.progress, [&](int, int j) {
    const Columns in = columns(Projection::sphere, size, j);
    for (int i = in.first; i < in.end; ++i)
      *level.texel(0, i, j) =
          disc.at({ball.x + scale * (i + 0.5 - 0.5 * size), ball.y + scale * (j + 0.5 - 0.5 * size)});
    level.trim();
  });
  return map_of(std::move(level));
}

FisheyeMap fisheye_map(const Level& photo, const Fisheye& lens, const Level* back, const PhotoMapOptions& options,
                       const std::optional<Fisheye>& back_lens) {
  check(lens.circle);
  if (back_lens) check(back_lens->circle);
  if (back && !back_lens && (back->width() != photo.width() || back->height() != photo.height()))
    throw InputError(fmt::format("the photo of the back must be of the same size, {}x{}, not {}x{}", photo.width(),
                                 photo.height(), back->width(), back->height()));
  constexpr double rounding = 1e-6;
  Level level = square_level(Projection::angular, std::ceil(2 * pi * lens.pixels_per_radian() - rounding), options);
  const Fisheye other = back_lens.value_or(lens);
  const Pair pair(lens, back ? std::optional(other) : std::nullopt);
  const Disc ahead(photo, lens.circle), behind(back ? *back : photo, other.circle);
  const int size = level.height();
  // Of each row the solid angle that is shown, and all of it, but for a factor.
  std::vector<std::array<double, 2>> solid(static_cast<std::size_t>(size));
  for_each_row(1, size, options.progress, [&](int, int j) {
    const double t = 1 - (2 * j + 1.0) / size;
    const Columns in = columns(Projection::angular, size, j);
    for (int i = in.first; i < in.end; ++i) {
      const double s = (2 * i + 1.0) / size - 1, r = std::min(1.0, std::sqrt(s * s + t * t));
      const Weights w = pair.over_texel(s, t, 2.0 / size);
      const double density = r > 0 ? portable::sin_pi(r) / r : pi;
      solid[std::size_t(j)][0] += (w.front + w.back) * density, solid[std::size_t(j)][1] += density;
      Flux sum(0);
      if (w.front > 0) sum += w.front * Flux(ahead.at(pair.front(s, t, r)));
      if (w.back > 0) sum += w.back * Flux(behind.at(pair.back(s, t, r)));
      *level.texel(0, i, j) = Colour(sum);
    }
    level.trim();
  });
  double shown = 0, all = 0;
  for (const auto& [of_row, whole] : solid) shown += of_row, all += whole;
  return {map_of(std::move(level)), shown / all};
}

EnvironmentMap paraboloid_map(const Level& front, const Level* back) {
  for (const Level* half : {&front, back})
    if (half && (half->width() != half->height() || half->height() != front.height()))
      throw InputError(fmt::format("half of a paraboloid map is square{}, not {}x{}",
                                   half == back ? fmt::format(" and {} high like the other half", front.height()) : "",
                                   half->width(), half->height()));
  Level level(Projection::paraboloid, front.height(), 0, front.max_memory());
  for (int j = 0; j < front.height(); ++j) {
    std::ranges::copy(front.row(0, j), level.row(0, j).begin());
    if (back) std::ranges::copy(back->row(0, j), level.row(1, j).begin());
    level.trim();
  }
  return map_of(std::move(level));
}

}  // namespace envmap
