#include "envmap/operate/photograph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/check_options.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/adaptive.h"
#include "envmap/sample/inverse_bilinear.h"
#include "envmap/sample/point.h"
#include "envmap/sample/pyramid.h"

namespace envmap {
namespace {

constexpr int max_samples = 32;

// Half the picture's height at a distance of 1, or half its angle.
double half_height(const PhotographOptions& o) {
  return o.lens == CameraModel::fisheye ? 0.5 * o.field_radians
                                        : portable::sin(0.5 * o.field_radians) / portable::cos(0.5 * o.field_radians);
}

void check(const PhotographOptions& o) {
  check_range(limits::picture_width, o.width);
  check_range(limits::picture_height, o.height);
  if (o.samples) check_range(limits::samples, *o.samples);
  check_range(limits::gain, o.gain);
  check_rotation("rotation", o.rotation);
  check_enumerator("lens", o.lens);
  check_enumerator("filter", o.filter);
  check_range({"field_radians", 1e-9, o.lens == CameraModel::fisheye ? 2 * pi : pi - 1e-9}, o.field_radians);
  if (o.filter == Filter::sat) throw UsageError("pictures do not take the filter sat");
  if (!of_points(o.filter) && o.lens != CameraModel::perspective)
    throw UsageError(fmt::format("pictures by {} take the filters nearest, bilinear and bicubic",
                                 camera_model_names[std::size_t(o.lens)]));
  if (!of_points(o.filter) && o.samples) throw UsageError("samples are for the filters nearest, bilinear and bicubic");
  if (o.lens == CameraModel::cylinder && angle_across(o) > 2 * pi * (1 + 1e-12))
    throw UsageError("a cylinder of that width goes round more than once");
}

// Where places in the picture look, in the frame of the source's image. Before the turn the camera looks along +Z,
// +X to its left.
struct Camera {
  CameraModel lens;
  double half, aspect;
  int width, height, samples;
  Rotation to_image;

  // Before the camera, at x to the right and y up in half heights. 0 beyond a fisheye's circle.
  [[nodiscard]] Direction direction(double x, double y) const {
    if (lens == CameraModel::perspective) return glm::normalize(Direction(-x * half, y * half, 1));
    if (lens == CameraModel::cylinder)
      return glm::normalize(Direction(-portable::sin(x * half), y * half, portable::cos(x * half)));
    const double r = portable::hypot(x, y), angle = r * half;
    if (r > 1) return Direction(0);
    const double k = r > 0 ? portable::sin(angle) / r : 0;
    return {-x * k, y * k, portable::cos(angle)};
  }

  // Of all samples of a pixel that lie in the picture.
  void look(int i, int row, std::vector<Direction>& directions) const {
    directions.clear();
    for (int b = 0; b < samples; ++b)
      for (int a = 0; a < samples; ++a) {
        const double u = (i + (a + 0.5) / samples) / width, v = (row + (b + 0.5) / samples) / height;
        const Direction d = direction(aspect * (2 * u - 1), 1 - 2 * v);
        if (d != Direction(0)) directions.push_back(to_image * d);
      }
  }
};

void sample(const PaddedLevel& base, Filter filter, std::span<const Direction> directions,
            std::span<Location<double>> at, std::span<Colour> out) {
  if (filter == Filter::nearest) {
    locate(base.projection(), directions, at);
    return sample_nearest(base, at, out);
  }
  locate_for_bilinear(base.projection(), base.height(), directions, at);
  filter == Filter::bilinear ? sample_bilinear(base, at, out) : sample_bicubic(base, at, out);
}

// The mean of points in a pixel. @param directions, places, found: room to work in.
struct PointMean {
  const Camera& camera;
  const PaddedLevel& base;
  Filter filter;
  double gain;
  std::vector<Direction> directions = {};
  std::vector<Location<double>> places = {};
  std::vector<Colour> found = {};

  Colour operator()(int i, int row) {
    const auto each = std::size_t(camera.samples * camera.samples);
    places.resize(each), found.resize(each);
    camera.look(i, row, directions);
    const std::span<Colour> colours = std::span(found).first(directions.size());
    sample(base, filter, directions, std::span(places).first(directions.size()), colours);
    Rgb<double> sum(0);
    for (const Colour& c : colours) sum += Rgb<double>(c);
    return Colour(sum * (gain / double(each)));
  }
};

// Pixels of a perspective picture are rectangles on the plane of a cube's face +Z, on which it goes on: what filters of
// maps know of texels they know of these.
class FootprintMean {
 public:
  FootprintMean(const Camera& camera, const std::vector<PaddedLevel>& levels, Filter filter, double floor, double gain)
      : camera_(camera), levels_(levels), filter_(filter), floor_(floor), gain_(gain) {}

  Colour operator()(int i, int row) const {
    const Point2 low = on_face(i, row), high = on_face(i + 1, row + 1);
    if (filter_ != Filter::area) return Colour(gain_ * mean_of_probes(low, high));
    constexpr double tolerance = FilterOptions{}.area_error;
    return Colour(gain_ * Rgb<double>(adaptive_mean(levels_.front(), target_, tolerance, floor_, face, low, high)));
  }

 private:
  static constexpr int face = 4, rows = 1024;  // Rows of the face: only how far a texel is.

  [[nodiscard]] Point2 on_face(int i, int row) const {
    const double s = camera_.aspect * (2.0 * i / camera_.width - 1), t = 2.0 * row / camera_.height - 1;
    return 0.5 + 0.5 * camera_.half * Point2(s, t);
  }

  [[nodiscard]] Rgb<double> mean_of_probes(const Point2& low, const Point2& high) const {
    const PaddedLevel& base = levels_.front();
    const Jacobian by_texel = jacobian(target_, base.projection(), base.height(), face, 0.5 * (low + high));
    const Point2 texels = double(rows) * (high - low);
    const Jacobian by_pixel{texels.x * by_texel.du, texels.y * by_texel.dv};
    const Probes plan = filter_ == Filter::ewa         ? ewa_plan(by_pixel)
                        : filter_ == Filter::trilinear ? trilinear_plan(by_pixel)
                                                       : nearest_level_plan(by_pixel);
    std::vector<Point2> points;
    for (int b = 0; b < plan.down; ++b)
      for (int a = 0; a < plan.across; ++a)
        points.push_back(low + Point2((a + 0.5) / plan.across, (b + 0.5) / plan.down) * (high - low));
    std::vector<Direction> directions(points.size());
    std::vector<Location<double>> places(points.size());
    std::vector<Colour> colours(points.size());
    envmap::directions(target_.to, face, points, directions);
    target_.bring_to_source(directions);
    locate_for_bilinear(base.projection(), base.height(), directions, places);
    sample_trilinear(levels_, places, plan.lod, colours);
    Rgb<double> sum(0);
    for (const Colour& c : colours) sum += Rgb<double>(c);
    return sum / double(colours.size());
  }

  const Camera& camera_;
  const std::vector<PaddedLevel>& levels_;
  Filter filter_;
  double floor_, gain_;
  Target target_{Projection::cube, rows, camera_.to_image};
};

}  // namespace

double angle_across(const PhotographOptions& o) {
  check_range(limits::picture_height, o.height);
  return 2 * half_height(o) * o.width / o.height;
}

int samples_of(const PhotographOptions& o, const Level& source) {
  if (o.samples) return *o.samples;
  const double texel =
      visit(source.projection(), [](auto p) { return decltype(p)::span; }) * pi / 180 / source.height();
  const double pixel = 2 * half_height(o) / o.height;  // In the middle, where it is widest.
  return std::clamp(int(std::ceil(2 * pixel / texel)), 1, max_samples);
}

std::vector<Colour> photograph(EnvironmentMap source, const PhotographOptions& o, const Run& run) {
  check(o);
  const Direction towards = glm::normalize(checked_direction("towards", o.towards));
  require_finite(source);
  const Camera camera{.lens = o.lens,
                      .half = half_height(o),
                      .aspect = double(o.width) / o.height,
                      .width = o.width,
                      .height = o.height,
                      .samples = of_points(o.filter) ? samples_of(o, source.base()) : 1,
                      .to_image = glm::transpose(image_to_world(source.forward)) * glm::transpose(o.rotation) *
                                  upright_about(towards)};
  const double floor = o.filter == Filter::area ? 1e-3 * mean_radiance(source.base()) : 0;
  if (reads_levels(o.filter)) add_levels(source.levels);
  std::vector<PaddedLevel> levels;
  for (Level& level : source.levels) {
    levels.emplace_back(std::move(level));
    if (!reads_levels(o.filter)) break;
  }
  const auto width = std::size_t(o.width);
  std::vector<Colour> picture(width * std::size_t(o.height));
  const auto take_row = [&](int row) {
    const std::span<Colour> pixels = std::span(picture).subspan(std::size_t(row) * width, width);
    const auto fill = [&](auto&& mean) {
      for (int i = 0; i < o.width; ++i) pixels[std::size_t(i)] = mean(i, row);
    };
    of_points(o.filter) ? fill(PointMean{camera, levels.front(), o.filter, o.gain})
                        : fill(FootprintMean(camera, levels, o.filter, floor, o.gain));
    levels.front().trim();
  };
  run_operation(run, [&](const Progress& progress) {
    for_each_row(1, o.height, progress, [&](int, int row) { take_row(row); });
  });
  return picture;
}

}  // namespace envmap
