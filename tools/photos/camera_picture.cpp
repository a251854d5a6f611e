#include "photos/camera_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/images/picture.h"
#include "maps/depfile.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

// The library's message is of radians.
double radians_of(double degrees, CameraModel lens) {
  const bool fisheye = lens == CameraModel::fisheye;
  if (!(degrees > 0 && (fisheye ? degrees <= 360 : degrees < 180)))
    throw UsageError(fmt::format("--fov {:g}: a {} picture sees more than 0 and {} degrees", degrees,
                                 camera_model_names[number_of("lens", lens)], fisheye ? "up to 360" : "less than 180"));
  return pi / 180 * degrees;
}

PhotographOptions resolved(const PhotographJob& job) {
  PhotographOptions o = job.photograph;
  o.field_radians = radians_of(job.field.value_or(o.lens == CameraModel::fisheye    ? 180
                                                  : o.lens == CameraModel::cylinder ? 90
                                                                                    : 60),
                               o.lens);
  o.height = job.height.value_or(480);
  o.width = 1;
  const double once_round = 2 * pi / angle_across(o);
  o.width = job.width.value_or(o.lens == CameraModel::fisheye       ? o.height
                               : o.lens == CameraModel::perspective ? (4 * o.height + 2) / 3
                                                                    : int(std::clamp(once_round, 1.0, 65536.0)));
  return o;
}

void tell_clipping(const std::string& path, std::span<const Colour> picture) {
  std::int64_t pixels = 0;
  double all = 0, lost = 0;
  for (const Colour& c : picture) {
    const Colour excess = glm::max(c - Colour(1), Colour(0));
    pixels += excess != Colour(0);
    lost += excess.x + excess.y + excess.z;
    all += c.x + c.y + c.z;
  }
  if (pixels > 0)
    note(fmt::format("{}: clipped {} pixels at 1, {:.3g}% of the light lost: use --display neutral to compress it",
                     path, pixels, 100 * lost / all));
}

}  // namespace

int take_photograph(const PhotographJob& job, Report& report) {
  const PictureOptions how{job.format, job.display.value_or(Display::clip), settings().commit};
  if (!is_picture(job.output, how)) throw UsageError(job.output, "the picture must be a .png, .jpg, .exr or .hdr");
  if (job.display && is_linear_picture(job.output, how))
    throw UsageError(job.output, "holds radiance as it is: remove --display");
  Source source = read_map(job.input, job.read);
  grade(source, job.grade, job.read.colour);
  PhotographOptions options = resolved(job);
  if (job.turn) options.rotation = rotation_of(*job.turn, source.map);
  if (of_points(options.filter)) options.samples = samples_of(options, source.map.base());
  open_depfile(1);
  const std::vector<Colour> picture = photograph(std::move(source.map), options);
  if (how.display == Display::clip && !is_linear_picture(job.output, how)) tell_clipping(job.output, picture);
  write_picture(job.output, options.width, picture, how);
  report.put("input", job.input);
  report.put("filter", name(options.filter));
  report.put("samples", options.samples.value_or(1));
  report.put("error", nullptr);
  report.put("lens", camera_model_names[std::size_t(options.lens)]);
  report.put("width", options.width);
  report.put("height", options.height);
  report.put("output", job.output);
  report.put_seconds();
  return 0;
}

}  // namespace tools
