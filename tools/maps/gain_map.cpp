#include "maps/gain_map.h"

#include <fmt/format.h>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "maps/depfile.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

void put_deviation(Report& report, const std::string& name, const Deviation& of) {
  report.put("gain_map." + name + ".texels", of.texels);
  report.put("gain_map." + name + ".max", of.maximum);
  report.put("gain_map." + name + ".rms", of.rms);
}

void put(Report& report, const std::string& path, const GainMapWritten& made) {
  report.put_written(path, made.written);
  report.put("gain_map.headroom", made.map.headroom);
  report.put("gain_map.least", made.map.of[0].least);
  report.put("gain_map.gamma", made.map.of[0].gamma);
  report.put("gain_map.width", made.map.width);
  report.put("gain_map.height", made.map.height);
  report.put("gain_map.channels", made.map.channels);
  report.put("gain_map.picture_quality", made.picture_quality);
  report.put("gain_map.gain_quality", made.gain_quality);
  report.put("gain_map.bytes", made.bytes);
  put_deviation(report, "above_white", made.error.above);
  put_deviation(report, "below_white", made.error.below);
}

std::string words(const Deviation& d) {
  return d.texels > 0 ? fmt::format("max {:.2e}, rms {:.2e}", d.maximum, d.rms) : "no texel";
}

}  // namespace

void add_gain_map(Options& o, GainMapRequest& request) {
  o.flag("--gain-map", request.wanted, ".jpg: keep light above white, see also --max-bytes and --gain-map-channels");
  Option& channels = o.add(
      "--gain-map-channels", "1|3",
      [&request](const std::string& word) {
        request.channels = word == "1" ? 1 : 3;
        return word == "1" || word == "3";
      },
      "Gains of 1 or of 3 channels: {} (default: 3)");
  channels.needs = "--gain-map", channels.folded = true;
}

void add_max_bytes(Options& o, GainMapRequest& request) {
  Option& size = o.add("--max-bytes", "SIZE", Size{&request.max_bytes, false}, {1, 0x1p40},
                       "--gain-map: size limit of the file, such as 500K (default: none)");
  size.needs = "--gain-map", size.folded = true;
}

GainMapOptions gain_map_options(const GainMapRequest& request) {
  GainMapOptions options{.channels = request.channels, .display = request.display};
  if (request.max_bytes > 0) options.max_bytes = request.max_bytes;
  return options;
}

bool write_gain_map(const std::string& path, const Rows& rows, const GainMapOptions& how, std::optional<double> asked,
                    const WriteOptions& options, Report& report) {
  WriteOptions with_files = options;
  with_files.commit = settings().commit;
  const std::vector<std::string> colours = out_of_working(options.colour).files;
  settings().also_read.insert(settings().also_read.end(), colours.begin(), colours.end());
  open_depfile(1);
  try {
    const GainMapWritten made = envmap::write_gain_map(path, rows, how, with_files);
    tell_clamping(path, made.written);
    put(report, path, made);
    note(fmt::format("{}: {} bytes, gain map of {}. Errors above white: {}. Below: {}", path, made.bytes,
                     made.map.words(), words(made.error.above), words(made.error.below)));
    return true;
  } catch (const AccuracyError& e) {
    const std::string error = asked ? fmt::format("--max-error {:g}", *asked) : "",
                      bytes = how.max_bytes ? fmt::format("--max-bytes {}", *how.max_bytes) : "";
    warn(fmt::format("envmap convert: {}: cannot meet {}{}{}: {}", path, error,
                     error.empty() || bytes.empty() ? "" : " and ", bytes, e.what()));
    return false;
  }
}

}  // namespace tools
