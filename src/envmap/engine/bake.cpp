#include "envmap/engine/bake.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/engine/baked_maps.h"
#include "envmap/engine/irradiance.h"
#include "envmap/engine/jpeg_background.h"
#include "envmap/engine/suns.h"
#include "envmap/io/files/output_folder.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/io/write_gain_map.h"
#include "envmap/io/write_table.h"
#include "envmap/light/light_error.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/brdf_table.h"

namespace envmap {
namespace {

constexpr std::string_view readme = "README.txt";

// README.txt ends with a line of the folder's files, by which the next bake knows what it may replace.
std::string files_key(const Engine& engine) { return fmt::format("Files for {}: ", family_of(engine)); }

// The files that an earlier bake for this engine lists as its own.
std::vector<std::string> files_there(const std::string& folder, const Engine& engine) {
  std::vector<std::string> files;
  std::ifstream text(folder + "/" + std::string(readme));
  const std::string key = files_key(engine);
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with(key)) continue;
    std::istringstream names(line.substr(key.size()));
    files.assign(std::istream_iterator<std::string>(names), {});
  }
  return files;
}

std::string readme_text(const Engine& e, const std::vector<BakedFile>& maps, double exposure) {
  std::string text = fmt::format("Light for {} ({}): linear RGB radiance{}.\n\n", e.title, e.version,
                                 exposure == 0 ? "" : fmt::format(", multiplied by 2^{:g}", exposure));
  for (const BakedFile& map : maps)
    text += fmt::format("{}: {}, {}x{}{}, {}; {}.\n", map.name, frame_words(map.frame), map.width, map.size,
                        map.levels > 1 ? fmt::format(" in {} levels", map.levels) : "",
                        is_jpeg(map.name) ? "8 bits and a gain map" : name(map.written.depth), map.accuracy);
  return text + fmt::format("Orientation: {}\nRough and diffuse light: {}.\n\n{}\n", turns_of(e), e.light, e.steps);
}

// The part of README.txt on the suns: which file brings them, in which unit, and how exact that is.
std::string suns_text(const Engine& e, const FoundLights& suns, const LightError& error) {
  std::string text =
      fmt::format("Suns: {} brings {}, which the maps leave out. {}\n", suns_file_name(e),
                  suns.lights.size() == 1 ? "a light" : fmt::format("{} lights", suns.lights.size()), suns_unit(e));
  for (const DiscLight& light : suns.lights)
    text += fmt::format(
        "  irradiance {:.6g} {:.6g} {:.6g} from ({:.6f}, {:.6f}, {:.6f}) of the probe, diameter {:.4g} "
        "degrees{}\n",
        light.irradiance.x, light.irradiance.y, light.irradiance.z, light.towards.x, light.towards.y, light.towards.z,
        2 * light.radius_degrees, light.radius_is_bound ? " at most" : "");
  return text + fmt::format(
                    "Lights without a size and maps together are as the probe, in every direction: irradiance "
                    "within {:.2g}% of its largest, GGX of roughness 0.5 within {:.2g}%.\n\n",
                    100 * error.irradiance, 100 * error.ggx);
}

// Lights get the exposure that the maps get.
void expose(FoundLights& suns, double gain) {
  for (DiscLight& light : suns.lights)
    for (Flux* const value : {&light.flux, &light.radiance, &light.irradiance, &light.spread}) *value *= gain;
}

void expose(EnvironmentMap& probe, double stops, Provenance& provenance) {
  const double gain = portable::exp2(stops);
  if (gain != 1) {
    require_finite(probe);
    apply(Grade{.gain = Flux(gain)}, probe.base());
    require_no_overflow(probe.base(), fmt::format("{:g} stops", stops), "exposure");
  }
  if (auto& luminance = provenance.white_luminance) luminance = float(*luminance / gain);
}

// The loader of an engine may take one depth alone.
void check_depth(const Engine& engine, const BakeOptions& options) {
  for (const EngineMap& map : engine.maps)
    if (map.only_depth && options.write.depth && options.write.depth != map.depth)
      throw UsageError(fmt::format("{} loads {} in {} alone, not in {}", engine.title, map.file, name(*map.depth),
                                   name(*options.write.depth)));
}

BakedFile described(const EngineMap& map, const BakedMap& made, const Written& written, const std::string& accuracy) {
  const Rows& base = made.rows.front();
  return {std::string(map.file), map.frame, base.width(), base.size, int(made.rows.size()), written, accuracy};
}

std::string of_gains(const GainMapError& e) {
  const auto words = [](const Deviation& d) { return fmt::format("within {:.2g} (rms {:.2g})", d.maximum, d.rms); };
  return fmt::format("; its gain map gives that back {} above white and {} below", words(e.above), words(e.below));
}

// A gain map rounds by what the map and the limit make of it. Half of the limit is left to each of filter and file.
BakedFile bake_gain_map(const EngineMap& map, const EnvironmentMap& probe, const std::string& file,
                        const WriteOptions& how, const BakeOptions& options, const Progress& progress) {
  constexpr double made_part = 0.3;  // Qualities are tried.
  BakeOptions resampled = options;
  GainMapOptions gains;
  if (const auto& most = options.max_error) {
    resampled.max_error = 0.5 * *most;
    gains.max_error = 0.5 * *most / (1 + 0.5 * *most);
  }
  WriteOptions of_gain_map = how;
  of_gain_map.depth.reset();
  const Rounding none{.depth = Depth::single};
  const BakedMap made = Baker(probe, resampled).make(map, none, part_progress(progress, 0, made_part));
  const GainMapWritten written = write_gain_map(file, made.rows.front(), gains, of_gain_map,
                                                {.progress = part_progress(progress, made_part, 1 - made_part)});
  const std::string accuracy =
      options.max_error
          ? fmt::format("read from it within {:g}, in the texels where the filter was measured", *options.max_error)
          : made.accuracy;
  return described(map, made, written.written, accuracy + of_gains(written.error));
}

// Makes and writes one map into the hidden folder.
BakedFile bake_map(const EngineMap& map, const EnvironmentMap& probe, Baker& baker, const OutputFolder& folder,
                   const std::string& shown, const BakeOptions& options, const Progress& progress) {
  constexpr double made_part = 0.8;  // The rest is the time to write.
  const std::string file = folder.file(map.file);
  WriteOptions how = options.write;
  if (!how.depth) how.depth = map.depth;
  how.zstd = map.zstd;
  check_output(file, how, map.frame.projection, map.chain.has_value());
  try {
    if (is_jpeg(map.file)) return bake_gain_map(map, probe, file, how, options, progress);
    const BakedMap made = baker.make(map, rounding_of(file, how), part_progress(progress, 0, made_part));
    how.pairs = made.pairs, how.facts = made.facts;
    const Written written =
        write(file, made.rows, how, {.progress = part_progress(progress, made_part, 1 - made_part)});
    return described(map, made, written, made.accuracy);
  } catch (const OutputError& e) {
    throw folder.with_final_path(e, map.file);
  } catch (const AccuracyError& e) {
    throw AccuracyError(shown, fmt::format("an error of {:g} cannot be met: {}", *options.max_error, e.what()),
                        e.remedy());
  }
}

// Writes what shaders need beside the maps.
void write_tables(const Engine& engine, const EnvironmentMap& probe, const OutputFolder& folder,
                  const CommitOptions& commit) {
  constexpr int size = 128;
  const auto write = [&](std::string_view file, const char* lobe, auto table) {
    if (file.empty()) return;
    try {
      write_table(folder.file(file), table(size, Run{}), size, lobe, commit);
    } catch (const OutputError& e) {
      throw folder.with_final_path(e, file);
    }
  };
  write(engine.table, "ggx", brdf_table);
  write(engine.sheen, "charlie", sheen_table);
  if (!engine.irradiance.empty())
    folder.write(engine.irradiance,
                 harmonics_pair(IrradianceForm::filament, irradiance_polynomial(project(probe, 2))).second);
}

void check_quality(const Quality& quality) {
  check_range(limits::doublings, quality.environment);
  check_range(limits::doublings, quality.chain);
  check_range(limits::max_error, quality.max_error);
}

// One that is not of the table may lack what its maps are made by.
void check_engine(const Engine& engine) {
  if (engine.maps.empty()) throw UsageError(fmt::format("the engine '{}' takes no maps", engine.name));
  for (const EngineMap& map : engine.maps) {
    check_enumerator("projection", map.frame.projection);
    check_enumerator("mirror", map.mirror);
    if (map.depth) check_enumerator("depth", *map.depth);
    if (!map.chain) continue;
    check_enumerator("irradiance", map.chain->irradiance);
    if (map.chain->roughness == nullptr) throw UsageError(fmt::format("{} needs a function roughness", map.file));
  }
}

}  // namespace

std::vector<std::string> files_of(const Engine& engine) {
  std::vector<std::string> files;
  for (const EngineMap& map : engine.maps) files.emplace_back(map.file);
  files.emplace_back(readme);
  for (const std::string_view file : {engine.text.name, engine.table, engine.sheen, engine.irradiance})
    if (!file.empty()) files.emplace_back(file);
  return files;
}

std::vector<std::string> files_of(const Engine& engine, const BakeOptions& options) {
  std::vector<std::string> files = files_of(engine);
  if (!options.suns) return files;
  if (std::string suns = suns_file_name(engine); std::ranges::find(files, suns) == files.end())
    files.push_back(std::move(suns));
  return files;
}

std::vector<BakedFile> bake(EnvironmentMap probe, const Engine& engine, const std::string& folder,
                            const BakeOptions& asked, const Run& run) {
  if (asked.size) check_range(limits::size, *asked.size);
  if (asked.chain_size) check_range(limits::chain_size, *asked.chain_size);
  if (asked.max_error) check_range(limits::max_error, *asked.max_error);
  check_range(limits::exposure, asked.exposure);
  check_quality(asked.quality);
  check_engine(engine);
  check_depth(engine, asked);
  BakeOptions options = asked;
  return run_operation(run, [&](const Progress& progress) {
    LightError error;
    if (options.suns) {
      error = light_error(probe, *options.suns);
      take_out(probe, *options.suns);
      expose(*options.suns, portable::exp2(options.exposure));
    }
    expose(probe, options.exposure, options.write.provenance);
    const std::vector<std::string> files = files_of(engine, options);
    OutputFolder out(folder, files, files_there(folder, engine), options.write.commit);
    Baker baker(probe, options);
    std::vector<BakedFile> baked;
    const double share = 1 / double(engine.maps.size());
    for (const EngineMap& map : engine.maps)
      baked.push_back(bake_map(map, probe, baker, out, folder + "/" + std::string(map.file), options,
                               part_progress(progress, share * double(baked.size()), share)));
    write_tables(engine, probe, out, options.write.commit);
    if (!engine.text.name.empty()) out.write(engine.text.name, engine.text.text);
    std::string about = readme_text(engine, baked, options.exposure);
    if (options.suns) {
      const auto [name, text] = suns_file(engine, options.suns->lights);
      out.write(name, text);
      about += suns_text(engine, *options.suns, error);
    }
    out.write(readme, about + fmt::format("{}{}\n", files_key(engine), fmt::join(files, " ")));
    out.commit();
    return baked;
  });
}

}  // namespace envmap
