// --for ENGINE of commands that write one map: what the engine's row of the table settles.
#pragma once

#include <optional>
#include <string>

#include "cli/report.h"
#include "envmap/engine/engines.h"
#include "shared/map_options.h"

namespace tools {

/// --for. 'list' sets `list`. @throws Asked with engine_list() where `list` is null.
Option& add_engine(Options& o, const envmap::Engine*& engine, std::string_view help, bool* list = nullptr);

/// "babylon|bevy|...".
std::string engine_names();

/// The engines, what they load, and how the map's directions stand there, as a text.
std::string engine_list();

/// "latlong, +x at the centre".
std::string frame_words(const envmap::Frame& frame);

/// The map that shows the environment. @throws UsageError where the engine takes it as a chain of rising roughness alone.
const envmap::EngineMap& environment_of(const envmap::Engine& engine);

/// The map that holds the environment seen through a lobe, of those that the engine takes; else the one that shows it.
const envmap::EngineMap& prefiltered_of(const envmap::Engine& engine, bool diffuse);

/// Projection, forward axis, file type and depth of the engine's map, where nothing else was asked for. A depth that was asked for
/// stays. @throws UsageError where another of the options contradicts.
void settle(const envmap::Engine& engine, const envmap::EngineMap& map, const std::string& output, std::optional<envmap::Projection>& to,
            std::optional<envmap::Forward>& forward, envmap::WriteOptions& write);
/// The same for a command that has neither --to nor --forward.
void settle(const envmap::Engine& engine, const envmap::EngineMap& map, const std::string& output, envmap::WriteOptions& write);

/// Says how the map's directions stand in the engine's world.
void tell_frame(const std::string& path, const envmap::Engine& engine, const envmap::EngineMap& map);
/// The same in a report.
void add_frame(Report& report, const envmap::Engine& engine, const envmap::EngineMap& map);
/// Says what the engine's loader would cut off without a word.
void tell_what_is_cut(const envmap::Engine& engine, const envmap::Level& level, const std::string& command);

}  // namespace tools
