/// @file
/// Reading environment maps: files, standard input, one file a face.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/io/claims/colour.h"
#include "envmap/io/face_files.h"
#include "envmap/io/images/depth.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/metadata.h"
#include "envmap/map/environment_map.h"
#include "envmap/map/layout.h"

namespace ENVMAP_EXPORT envmap {

/// 24 GiB of float RGB, as 65536x32768.
inline constexpr std::uint64_t default_max_pixels = std::uint64_t{1} << 31;

/// What to do with NaN, infinite and negative radiance.
enum class FlawPolicy { refuse, repair, keep };
template <>
inline constexpr std::size_t enumerators<FlawPolicy> = std::size_t(FlawPolicy::keep) + 1;

/// What the user says of the file; where nothing is said the metadata decides, then the shape.
struct ReadOptions {
  std::optional<Projection> projection = {};
  std::optional<Layout> layout = {};
  std::string faces = {};               ///< Names and turns of the six files of a name with `{face}`: see face_files().
  std::optional<Forward> forward = {};  ///< Overrides the metadata.
  std::optional<Forward> assumed_forward = {};  ///< Where there is no metadata; otherwise +z.
  std::optional<int> border = {};        ///< Texels round an octahedral map, to be left out; overrides the metadata.
  bool ignore_envmap_attribute = false;  ///< Take texels as cell-centred whatever OpenEXR's attribute says.
  bool border_samples = false;  ///< Samples lie on the border of the image, though no attribute of OpenEXR says so.
  bool apply_pose = false;      ///< Turn a panorama as its camera was held, where XMP (GPano) says how.
  std::size_t max_memory = 0;  ///< Bytes that the process may take; larger maps lie in a scratch file. 0: no limit.
  std::uint64_t max_pixels = default_max_pixels;  ///< Of an image, all faces counted; larger ones are refused.
  bool drop_channels = false;                     ///< Read RGB and leave alpha and other channels behind.
  ImageChoice choice = {};                        ///< Which of the images of an EXR file.
  FlawPolicy flaws = FlawPolicy::refuse;
  ColourOptions colour = {};
  int level = 0;            ///< The level to read, as the only one of the map.
  bool all_levels = false;  ///< Read them all; `level` must be 0.
};

struct Source {
  EnvironmentMap map = {};
  Layout layout = Layout::single;
  Depth depth = Depth::single;
  std::string format = {};          ///< openexr, hdr, ktx, ktx2, dds, ...; else OpenImageIO's name for it.
  bool forward_is_assumed = false;  ///< Neither the file nor the caller says what axis is at the centre.
  int image_width = 0, image_height = 0;
  bool border_samples = false;  ///< OpenEXR's `envmap` convention; resampled to cell centres here.
  std::optional<Rotation> pose = {};  ///< Of the camera, where it was asked for: the map is turned by it.
  int border = 0;               ///< Texels round every level of an octahedral map, left out here.
  int levels = 1;               ///< That the file has; `map` holds those that were asked for.
  Facts facts = {};             ///< Further metadata, such as the lobe.
  Provenance provenance = {};   ///< Of the map: its chromaticities are those of the working space.
  ClaimedSpace claimed = {};    ///< What the file says of its colours; `by` is empty where it says nothing.
  std::vector<std::string> files = {};         ///< That were read beside it: buffers and images of glTF.
  std::vector<std::string> colour_files = {};  ///< The config and its tables, where they were read.
  std::int64_t repaired = 0;                   ///< Texels that FlawPolicy::repair changed.
  std::vector<std::string> notes = {};         ///< What of the file is not read, or was added.
  std::vector<std::string> details = {};       ///< What reading did to the values, such as dividing an exposure out.
  std::vector<Claim> claims = {};              ///< What the file states, and what became of it.
};

/// @param path a file, `-` for standard input, or a name with `{face}` for six files, `{half}` for
/// a paraboloid's (front back) and `{level}` for those of all levels, numbered from 0.
/// @throws InputError in one line, naming the file; UsageError where the options contradict each other.
Source read(const std::string& path, const ReadOptions& options = {}, const Run& run = {});

/// Reads the bytes of a file in memory, which are copied. Errors name no file.
Source read(std::span<const std::byte> file, const ReadOptions& options = {}, const Run& run = {});

}  // namespace envmap
