// Options for reading and writing maps, which several commands have.
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "envmap/io/images/picture.h"
#include "envmap/io/read.h"
#include "envmap/io/write.h"
#include "envmap/sample/filter.h"

namespace tools {

std::string projection_words();  ///< All projections, with | between.

Option& add_projection(Options& o, std::string_view name, std::optional<envmap::Projection>& value,
                       std::string_view help);
Option& add_layout(Options& o, std::string_view name, std::optional<envmap::Layout>& value, std::string_view help);
void add_faces(Options& o, envmap::WriteOptions& write);
Option& add_forward(Options& o, std::string_view name, std::optional<envmap::Forward>& value, std::string_view help);
Option& add_filter(Options& o, std::optional<envmap::Filter>& value, std::string_view help);  ///< "auto" is no value.
Option& add_display(Options& o, std::optional<envmap::Display>& value, envmap::Display otherwise);
Option& add_size(Options& o, const Value& value, std::string_view help);
Option& add_exposure(Options& o, double& stops);

void add_read_options(Options& o, envmap::ReadOptions& read);  ///< --from to --ocio.
void add_max_pixels(Options& o, envmap::ReadOptions& read);
void add_max_memory(Options& o, envmap::ReadOptions& read);
void add_repair(Options& o, envmap::ReadOptions& read);
/// @param otherwise what help says of the default depth.
Option& add_depth(Options& o, envmap::WriteOptions& write, std::string_view otherwise = "as input");
void add_format(Options& o, envmap::WriteOptions& write);
void add_file_options(Options& o, envmap::WriteOptions& write);  ///< --openexr-envmap, --compression, --zstd.
void add_clamp(Options& o, envmap::WriteOptions& write);
/// --depth, --format, --clamp and the file options.
void add_write_options(Options& o, envmap::WriteOptions& write, std::string_view depth = "as input");
void add_border(Options& o, envmap::WriteOptions& write, std::string_view size);  ///< `size`: what help says of --size.
void add_output_space(Options& o, envmap::WriteOptions& write);                   ///< --output-space, --encoded.

/// The size of a map without its border. @throws UsageError where nothing is left.
int size_inside_border(int size, const envmap::WriteOptions& write);

/// An error that half does not hold, for depth_for_error() where a value is beyond half's range.
inline constexpr double below_half = 0x1p-12;

/// "--depth half": the least depth and what else of the options must go, so that the file holds an error;
/// empty where its format has none.
std::string depth_for_error(const std::string& path, const envmap::WriteOptions& options, double max_error);

}  // namespace tools
