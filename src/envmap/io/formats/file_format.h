/// @file
/// The list of file formats: what recognition, depths, error messages and tests go by.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "envmap/base/run.h"
#include "envmap/io/images/depth.h"
#include "envmap/maths/primaries.h"
#include "envmap/maths/vector.h"
#include "envmap/projection/projection.h"

namespace envmap {

class InputFile;
class OutputFile;
struct Atlas;
struct Image;
struct ImageChoice;
struct ImagePlan;
struct ImageWriter;
struct TexturePlan;
struct WriteOptions;

/// A row of the table. A new format is a row of it, with a reader and a writer in a file of their own.
struct FileFormat {
  enum Ability : unsigned {
    compression = 1,      ///< WriteOptions::compression.
    envmap_mark = 2,      ///< WriteOptions::openexr_envmap.
    row_range = 4,        ///< WriteOptions::rows.
    zstd = 8,             ///< WriteOptions::zstd.
    picture = 16,         ///< write_picture().
    table = 32,           ///< write_table().
    encoded_values = 64,  ///< Can say that its values are not linear.
    parts = 128,          ///< ImageChoice::part, layer and channels.
    window = 256,         ///< ImageChoice::crop.
    gain_map = 512,       ///< ImageChoice::headroom.
  };

  std::string_view name;   ///< As OpenImageIO names it, and info does.
  std::string_view title;  ///< As people do.
  /// Lower case, no dots. Of a format that is only read it may have none.
  std::span<const std::string_view> extensions;
  std::span<const Depth> depths;  ///< Written, least first; none where it is only read.
  /// Whether a file begins so: it is known by its bytes, not by its name. Null where it has no mark, only a name.
  bool (*is_head)(std::string_view head);
  bool frame = false;                                  ///< Written with its projection and the axis at its centre.
  double largest = std::numeric_limits<float>::max();  ///< Of its floats.
  bool levels = false;                                 ///< All levels of a map go into one file.
  bool texture = false;      ///< Holds the faces of a cube as such, not side by side in one image.
  bool cubes_alone = false;  ///< Of such a format: it holds nothing else.
  bool irradiance = false;   ///< Holds irradiance, too, which a map alone does not bring along.
  unsigned abilities = encoded_values;
  /// Sets the reader or the texture of an image. Null, or where neither is set then: OpenImageIO reads it.
  /// @throws InputError without the file's name.
  void (*open)(Image& image, const ImageChoice& choice) = nullptr;
  /// Writes a texture or an image row by row. @throws OutputError without the file's name.
  void (*write)(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan,
                const Progress& progress) = nullptr;
  /// Where there is no `write`: begins an image. Null: OpenImageIO writes it.
  ImageWriter (*create)(OutputFile& file, const ImagePlan& plan) = nullptr;
  /// Whether it has a number for primaries. Null: it names all of them, or none.
  bool (*names)(const Primaries& primaries) = nullptr;
  /// What is read back of floats, where that is something else.
  void (*round)(std::span<Colour> texels) = nullptr;
  /// Bytes that a texel surely takes. Null: 0.
  double (*least_bytes)(Depth depth, const WriteOptions& options) = nullptr;

  [[nodiscard]] bool can(Ability a) const { return (abilities & a) != 0; }
  [[nodiscard]] bool is_written() const { return !depths.empty(); }
};

/// Bytes at the beginning of a file that tell its format.
inline constexpr std::size_t head_size = 16;

std::span<const FileFormat> file_formats();

/// The format that is written under an extension (lower case, no dot), or null.
const FileFormat* format_with_extension(std::string_view extension);

/// The format of a file, or null. @param head its first bytes. @param path where it has no mark its name decides.
const FileFormat* format_of(std::string_view head, std::string_view path);

/// Of a path: lower case, no dot; empty where it has none.
std::string extension_of(std::string_view path);

/// "EXR, KTX2, ... or SGI": all that are read.
std::string readable_formats();
/// ".exr, ... or .webp": all that a map can be written to. @param levels whether one file must hold several.
std::string writable_extensions(Projection projection, bool levels);

}  // namespace envmap
