/// @file
/// The built-in config, in OpenColorIO's terms, and how its processors are made and applied.
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <span>
#include <string_view>

#include "envmap/maths/primaries.h"
#include "envmap/maths/vector.h"

namespace envmap {

namespace ocio = OCIO_NAMESPACE;

struct BuiltInSpace {
  std::string_view name;
  std::span<const std::string_view> aliases;  ///< As the ACES configs and OpenImageIO call it.
  Primaries primaries;
  std::string_view linear;  ///< The space without its curve, which is sRGB's; of a linear space itself.

  [[nodiscard]] bool is_linear() const { return linear == name; }
};

inline constexpr const char* linear_rec709 = "Linear Rec.709";
inline constexpr const char* aces2065_1 = "ACES2065-1";

std::span<const BuiltInSpace> built_in_spaces();

/// Finds a space by name, alias or role, ignoring case. @return null if there is none.
const BuiltInSpace* built_in_space(std::string_view name);

/// The spaces above, relative to linear Rec.709, and the roles scene_linear, default,
/// texture_paint and aces_interchange.
ocio::ConstConfigRcPtr built_in_config();

/// The same with one space more, of these primaries. @return its name through `name`.
ocio::ConstConfigRcPtr config_with(const Primaries& primaries, const char* name);

/// IEC 61966-2-1, decoding.
ocio::ExponentWithLinearTransformRcPtr srgb_curve();

/// Lossless: the default trades functions for approximations.
ocio::ConstCPUProcessorRcPtr on_cpu(const ocio::ConstProcessorRcPtr& processor);
void apply(const ocio::ConstCPUProcessorRcPtr& processor, std::span<Colour> colours);

}  // namespace envmap
