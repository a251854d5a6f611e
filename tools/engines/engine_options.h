// --for ENGINE of commands that write one map: what the engine's row of the table settles.
#pragma once

#include <optional>
#include <string>

#include "cli/report.h"
#include "envmap/engine/engines.h"
#include "maps/map_options.h"

namespace tools {

/// --for. @throws HelpRequested with engine_list() for the word 'list'.
Option& add_engine(Options& o, const envmap::Engine*& engine, std::string_view help);

/// "babylon|bevy|...".
std::string engine_names();

/// A table with a line for each engine.
std::string engine_list();
/// What one engine loads, in several lines.
std::string engine_text(const envmap::Engine& engine);
/// "latlong +x": the projection of the environment, and the axis at its centre.
std::string image_of(const envmap::Engine& engine);
/// Whether the engine itself loaded the files, or only its source was read.
bool was_run(const envmap::Engine& engine);

/// The row that a file of an engine is of: one that takes panoramas has a row for them.
const envmap::Engine& row_for(const envmap::Engine& engine, const std::string& output,
                              const envmap::WriteOptions& write);

/// The map that shows the environment. @throws UsageError where the engine takes it as a chain of rising roughness
/// alone.
const envmap::EngineMap& environment_of(const envmap::Engine& engine);

/// The map that holds the environment seen through a lobe, of those that the engine takes; else the one that shows it.
const envmap::EngineMap& prefiltered_of(const envmap::Engine& engine, bool diffuse);

/// Projection, forward axis, file type and depth of the engine's map, where nothing else was asked for. A depth that
/// was asked for stays. @param output empty where the file is written by another command: 'envmap merge'.
/// @throws UsageError where another of the options contradicts.
void resolve_for_engine(const envmap::Engine& engine, const envmap::EngineMap& map, const std::string& output,
                        std::optional<envmap::Projection>& to, std::optional<envmap::Forward>& forward,
                        envmap::WriteOptions& write);
/// The same for a command that has neither --to nor --forward.
void resolve_for_engine(const envmap::Engine& engine, const envmap::EngineMap& map, const std::string& output,
                        envmap::WriteOptions& write);

/// Says how the map's directions stand in the engine's world.
void tell_frame(const std::string& path, const envmap::Engine& engine, const envmap::EngineMap& map);
/// The same in a report.
void add_frame(Report& report, const envmap::Engine& engine, const envmap::EngineMap& map);
/// Warns about values, multiplied by a gain, that the engine's loader clamps silently.
void warn_about_clamping(const envmap::Engine& engine, const envmap::Level& level, double gain,
                         const std::string& command);

}  // namespace tools
