#include <fmt/format.h>

#include "command.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/window.h"

namespace tools {
namespace {

using namespace envmap;

enum class Window { none, hann, automatic };
constexpr std::string_view window_names[] = {"none", "hann", "auto"};

struct Options {
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

std::string text(const Harmonics& h, const Options& o) {
  std::string lines;
  if (o.window == Window::automatic)
    lines += o.deringing.lambda > 0
                 ? fmt::format("# degree l times 1 / (1 + {:.6g} l^2 (l + 1)^2), the weakest of no negative irradiance; it changes "
                               "the irradiance by {:.1e} (rms), {:.1e} of its mean at most\n",
                               o.deringing.lambda, o.deringing.rms, o.deringing.maximum)
                 : "# no window: the irradiance is not negative without one\n";
  lines += fmt::format("# {} to order {}: l m red green blue\n", o.irradiance ? "irradiance" : "radiance", h.order);
  for (int l = 0; l <= h.order; ++l)
    for (int m = -l; m <= l; ++m) {
      const Flux& c = h.coefficients[static_cast<std::size_t>(l * (l + 1) + m)];
      lines += fmt::format("{:3} {:4} {:17.9e} {:17.9e} {:17.9e}\n", l, m, c.x, c.y, c.z);
    }
  return lines;
}

nlohmann::ordered_json report_of(const Harmonics& h, const Options& o) {
  nlohmann::ordered_json report;
  report["file"] = o.input;
  report["quantity"] = o.irradiance ? "irradiance" : "radiance";
  report["basis"] =
      "real, orthonormal, polar axis +Y, longitude from +Z to +X, m > 0 cosines, m < 0 sines, no Condon-Shortley phase";
  report["order"] = h.order;
  if (o.window != Window::none) report["window"] = window_names[static_cast<std::size_t>(o.window)];
  if (o.window == Window::automatic)
    report["deringing"] = {{"lambda", o.deringing.lambda}, {"rms", o.deringing.rms}, {"max", o.deringing.maximum}};
  for (const Flux& c : h.coefficients) report["coefficients"].push_back(to_json(c));
  return report;
}

int run(Options& o, const Common& common) {
  const Projection to = o.to.value_or(Projection::cube);
  if (!o.output.empty()) check_output(o.output, o.write, to);
  else if (!common.depfile.empty()) throw UsageError("--depfile is for the map of --evaluate");
  check_files({o.output}, {o.input}, common);
  check_report(o.output, common);
  if (o.window == Window::automatic && o.order > most_deringed_order)
    throw UsageError(fmt::format("--window auto is for --order up to {}", most_deringed_order));
  o.read.assumed_forward = o.forward;
  const Source source = read_map(o.input, o.read, common);
  Harmonics h = project(source.map, o.order, progress_line(common, "sh"));
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
    write_map(o.output, rows_of(map), o.write, {o.input}, "sh", common);
    if (o.output == "-") return 0;
  }
  if (common.json)
    print_report(report_of(h, o));
  else
    print(text(h, o));
  return 0;
}

}  // namespace

Command sh_command() {
  return {.name = "sh",
          .summary = "Spherical-harmonic coefficients of a map, of its radiance or its irradiance",
          .description =
              "Prints the coefficients, the integrals of radiance x harmonic over the sphere, in lines 'l m red green "
              "blue' or "
              "with --json as an array in the order l (l + 1) + m. Each texel counts with its solid angle, radiance "
              "constant "
              "over it.\n\n"
              "The basis is real and orthonormal, in world axes: polar axis +Y, longitude from +Z to +X, m > 0 "
              "cosines, m < 0 "
              "sines, no Condon-Shortley phase. Of a unit vector (x, y, z) the first nine are 0.282095; 0.488603 x, "
              "0.488603 y, "
              "0.488603 z; 1.092548 xz, 1.092548 xy, 0.315392 (3 y^2 - 1), 1.092548 yz, 0.546274 (z^2 - x^2).\n\n"
              "--irradiance multiplies degree l by A_l = pi, 2 pi/3, pi/4, 0, -pi/24, ... (Ramamoorthi and Hanrahan "
              "2001): the "
              "series then is the irradiance E(n) of a plane with normal n, pi times what 'prefilter --lobe diffuse' "
              "gives. To "
              "order 2 it is right to some percent; round a sun it is not, and falls below 0 on the far side.\n\n"
              "--window multiplies each degree, for less ringing and less detail: 'hann' by (1 + cos(pi l / (N + 1))) / 2, 'auto' "
              "by 1 / (1 + lambda l^2 (l + 1)^2) with the least lambda of which the irradiance is nowhere negative (Sloan 2008, "
              "\"Stupid spherical harmonics tricks\"), whether --irradiance is asked for or not; it says lambda and what the "
              "irradiance changes by.",
          .examples = {{"envmap sh probe.hdr --irradiance", "nine colours that light diffuse surfaces"},
                       {"envmap sh sunny.hdr --irradiance --window auto", "the same, nowhere negative"},
                       {"envmap sh probe.hdr --order 4 --json", "25 colours of the radiance, as JSON"},
                       {"envmap sh probe.hdr --order 8 --window hann --evaluate soft.exr --to latlong --size 128 -q",
                        "what the series to order 8 shows, with less ringing"}},
          .keys = {{"file", "text", "INPUT"},
                   {"quantity", "text", "radiance or irradiance"},
                   {"basis", "text", "its conventions, in words"},
                   {"order", "count", "the largest degree l"},
                   {"window", "text?", "hann or auto; absent without --window"},
                   {"deringing", "object?", "absent but with --window auto"},
                   {"deringing.lambda", "number", "of the window; 0: none was needed"},
                   {"deringing.rms", "number", "of the change of the irradiance, relative to its rms"},
                   {"deringing.max", "number", "its largest change, relative to its mean"},
                   {"coefficients", "triples", "red, green and blue of each harmonic, in the order l (l + 1) + m"}},
          .reports = true,
          .writes = true,
          .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
            auto o = std::make_shared<Options>();
            app.add_option("INPUT", o->input, "File to read, '-' for standard input; {face} in the name reads six files")
                ->required();
            app.add_option("--order", o->order, "The largest degree l (default: 2)")->type_name("N")->check(CLI::Range(0, 200));
            app.add_flag("--irradiance", o->irradiance, "Coefficients of the irradiance, not of the radiance");
            add_choice(app, "--window", o->window, joined(window_names), one_of<Window>(window_names),
                       "Less ringing round bright lights for less detail (default: none; --window alone: hann)")
                ->expected(0, 1)
                ->default_str("hann");
            app.add_option("--evaluate", o->output, "Write the series as a map, too; below 0 it is cut to 0")
                ->type_name("OUT");
            add_projection(app, "--to", o->to, "Projection of that map (default: cube)");
            add_size(app, o->size, "Height of its faces (default: 64)");
            add_layout(app, "--layout", o->write.layout, "Where its cube faces lie (default: column)");
            add_forward(app, "--forward", o->forward,
                        "World axis at the centre of latlong and angular images (default: +z)");
            add_depth(app, o->write.depth);
            add_format(app, o->write);
            add_clamp(app, o->write);
            add_read_options(app, o->read);
            add_repair(app, o->read);
            return [o, &common] { return run(*o, common); };
          }};
}

}  // namespace tools
