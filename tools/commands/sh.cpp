#include <fmt/format.h>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/harmonics_window.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

enum class Window { none, hann, automatic };
constexpr std::string_view window_names[] = {"none", "hann", "auto"};

struct ShRequest {
  std::string input, output;
  ReadOptions read;
  WriteOptions write;
  int order = 2, size = 64;
  bool irradiance = false;
  Window window = Window::none;
  Deringing deringing;  // Of Window::automatic.
  std::optional<Projection> to;
  std::optional<Forward> forward;
};

std::string text(const Harmonics& h, const ShRequest& o) {
  std::string lines;
  if (o.window == Window::automatic)
    lines +=
        o.deringing.lambda > 0
            ? fmt::format(
                  "# degree l times 1 / (1 + {:.6g} l^2 (l + 1)^2), the weakest of no negative irradiance; it changes "
                  "the irradiance by {:.1e} (rms), {:.1e} of its mean at most\n",
                  o.deringing.lambda, o.deringing.rms, o.deringing.maximum)
            : "# no window: the irradiance is not negative without one\n";
  lines += fmt::format("# {} to order {}: l m red green blue\n", o.irradiance ? "irradiance" : "radiance", h.order);
  for (int l = 0; l <= h.order; ++l)
    for (int m = -l; m <= l; ++m) {
      const Flux& c = h.coefficients[std::size_t(l * (l + 1) + m)];
      lines += fmt::format("{:3} {:4} {:17.9e} {:17.9e} {:17.9e}\n", l, m, c.x, c.y, c.z);
    }
  return lines;
}

void add(Report& report, const Harmonics& h, const ShRequest& o) {
  report.put("file", o.input);
  report.put("quantity", o.irradiance ? "irradiance" : "radiance");
  report.put("basis",
             "real, orthonormal, polar axis +Y, longitude from +Z to +X, m > 0 cosines, m < 0 sines, no "
             "Condon-Shortley phase");
  report.put("order", h.order);
  if (o.window != Window::none) report.put("window", window_names[std::size_t(o.window)]);
  if (o.window == Window::automatic) {
    report.put("deringing.lambda", o.deringing.lambda);
    report.put("deringing.rms", o.deringing.rms);
    report.put("deringing.max", o.deringing.maximum);
  }
  for (const Flux& c : h.coefficients) report.append("coefficients[]", Direction(c));
}

int run(ShRequest& o, Report& report) {
  const Projection to = o.to.value_or(Projection::cube);
  if (!o.output.empty()) check_output(o.output, o.write, to);
  if (o.window == Window::automatic && o.order > max_deringed_order)
    throw UsageError(fmt::format("--window auto is for --order up to {}", max_deringed_order));
  if (o.output.empty() || !has_forward(to)) o.read.assumed_forward = o.forward;
  const Source source = read_map(o.input, o.read);
  Harmonics h = project(source.map, o.order, {.progress = progress_line("sh")});
  if (o.window == Window::automatic) {
    o.deringing = weakest_window(h);
    scale_degrees(h, laplacian_window(o.order, o.deringing.lambda));
  }
  if (o.window == Window::hann) scale_degrees(h, hann_window(o.order));
  if (o.irradiance) scale_degrees(h, irradiance_factors(o.order));
  if (!o.output.empty()) {
    const EnvironmentMap map = evaluate(h, to, o.size, o.forward.value_or(Forward::plus_z));
    o.write.source_depth = Depth::single;
    o.write.provenance = source.provenance;
    if (o.irradiance) o.write.provenance.white_luminance.reset();
    write_map(o.output, rows_of(map), o.write, "sh");
    if (o.output == "-") return 0;
  }
  add(report, h, o);
  if (!settings().json) print(text(h, o));
  return 0;
}

}  // namespace

Action define_sh(Options& o) {
  const auto r = std::make_shared<ShRequest>();
  o.reads("INPUT", r->input, "File to read, or '-' for stdin ({face} in the name reads six files)").required = true;
  o.group = "Coefficients";
  o.add("--order", "N", &r->order, range_of(limits::order), "Largest degree l (default: 2); the polar axis is +Y");
  o.flag("--irradiance", r->irradiance, "Print coefficients of the irradiance instead of the radiance");
  o.add("--window", one_of(r->window, window_names), "Reduce ringing around lights: {} (default: none; no value: hann)")
      .alone = "hann";
  o.group = "Map of --evaluate";
  o.add("--evaluate", "FILE", &r->output, "Write the series as a map, with negative values clamped to 0").file =
      File::output;
  add_projection(o, "--to PROJECTION", r->to, "{} (default: cube)");
  add_size(o, &r->size, "Height of the image or of one cube face (default: 64)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, r->write);
  add_forward(o, "--forward AXIS", r->forward, "Axis at the centre of latlong and angular maps: {} (default: +z)");
  add_depth(o, r->write, "float, or nearest");
  add_format(o, r->write);
  add_clamp(o, r->write);
  o.need("--evaluate", {"--to", "--size", "--layout", "--faces", "--depth", "--format", "--clamp"});
  add_read_options(o, r->read);
  add_repair(o, r->read);
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools
