/// @file
/// Exceptions of the library: an error code, the file and a remedy. The text does not mention command-line options.
/// Nothing else is thrown on purpose, except std::bad_alloc.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "envmap/base/bounds.h"
#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

enum class ErrorCode {
  usage,     ///< What was asked makes no sense.
  input,     ///< An input is unreadable or not what it claims to be.
  output,    ///< An output could not be written; nothing was left behind.
  renderer,  ///< There is nothing to draw with.
  accuracy,  ///< An error that was asked for cannot be met.
};
template <>
inline constexpr std::size_t enumerators<ErrorCode> = std::size_t(ErrorCode::accuracy) + 1;

/// What the caller may change so that the same request succeeds; a program words it in its own options.
enum class Remedy {
  none,
  choose_projection,      ///< ReadOptions::projection: a square image may be one of several.
  leave_out_from_layout,  ///< ReadOptions::layout: the file itself says where faces lie.
  leave_out_layout,       ///< WriteOptions::layout.
  leave_out_face,         ///< `{face}` in the file name: the file holds all faces.
  drop_channels,          ///< ReadOptions::drop_channels.
  repair,                 ///< ReadOptions::flaws = FlawPolicy::repair; of a map in memory repair().
  limit_memory,           ///< ReadOptions::max_memory.
  allow_pixels,           ///< ReadOptions::max_pixels.
  choose_format,          ///< WriteOptions::format, or a file name that ends in one.
  choose_plus_z,          ///< Forward::plus_z.
  clamp_or_deepen,        ///< WriteOptions::clamp, less light, or depth = Depth::single.
  clamp_or_darken,        ///< WriteOptions::clamp, less light, or a floating-point format.
  clamp_or_dim,           ///< WriteOptions::clamp, or less light: no depth of the format holds it.
  clamp_or_brighten,      ///< WriteOptions::clamp, more light, or depth = Depth::single.
  clamp_or_light_up,      ///< WriteOptions::clamp, or more light: no depth of the format holds it.
  choose_space,           ///< ReadOptions::colour.space.
  choose_linear,          ///< WriteOptions::colour.space: a linear one, or WriteOptions::encoded.
  choose_layer,           ///< ReadOptions::choice.layer.
  leave_out_shadows,      ///< FrameState::shadows = false, or fewer lights.
  force,                  ///< CommitOptions::force, or a file that may be written.
  find_circle,            ///< A photo of a ball: photo_map.h, find_circle.h.
  choose_faces,           ///< ReadOptions::faces.
  make_levels,            ///< Levels made by add_levels() instead of those of the source.
  make_cube,              ///< A cube, which convert() makes.
  take_base,              ///< ReadOptions::choice.headroom = 0: the picture without its gain map.
  make_all_levels,        ///< All levels down to one texel, which add_levels() makes.
};
template <>
inline constexpr std::size_t enumerators<Remedy> = std::size_t(Remedy::make_all_levels) + 1;

/// The enumerator as a word, for logs and for programs that word remedies themselves: "usage", "choose_projection".
std::string_view name(ErrorCode code);
std::string_view name(Remedy remedy);

/// The same in words for people: "an input is unreadable or not what it claims to be", and what to change, with the
/// names of this library: "set ReadOptions::drop_channels". Empty of Remedy::none.
std::string_view words(ErrorCode code);
std::string_view words(Remedy remedy);

class Error : public std::runtime_error {
 public:
  [[nodiscard]] ErrorCode code() const { return code_; }
  /// As the caller named it; empty where no file is at fault. what() begins with it.
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] Remedy remedy() const { return remedy_; }

 protected:
  Error(ErrorCode code, const std::string& file, const std::string& message, Remedy remedy)
      : std::runtime_error(file.empty() ? message : file + ": " + message), code_(code), remedy_(remedy), file_(file) {}

 private:
  ErrorCode code_;
  Remedy remedy_;
  std::string file_;
};

template <ErrorCode error_code>
struct ErrorOf : Error {
  explicit ErrorOf(const std::string& message, Remedy remedy = Remedy::none) : Error(error_code, {}, message, remedy) {}
  ErrorOf(const std::string& file, const std::string& message, Remedy remedy = Remedy::none)
      : Error(error_code, file, message, remedy) {}
};

struct UsageError : ErrorOf<ErrorCode::usage> {
  using ErrorOf::ErrorOf;
  UsageError(const Bounds& range, double value);

  /// The field whose value is out of its range, and that range; nothing of other errors.
  [[nodiscard]] const std::optional<Bounds>& range() const { return range_; }

 private:
  std::optional<Bounds> range_;
};
struct InputError : ErrorOf<ErrorCode::input> {
  using ErrorOf::ErrorOf;
};
struct OutputError : ErrorOf<ErrorCode::output> {
  using ErrorOf::ErrorOf;
};
struct RendererError : ErrorOf<ErrorCode::renderer> {
  using ErrorOf::ErrorOf;
};
struct AccuracyError : ErrorOf<ErrorCode::accuracy> {
  using ErrorOf::ErrorOf;
};

}  // namespace envmap
