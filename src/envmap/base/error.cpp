#include "envmap/base/error.h"

#include <array>

namespace envmap {
namespace {

struct Words {
  std::string_view name, text;
};

// In the order of the enumerators.
constexpr std::array<Words, enumerators<ErrorCode>> codes{{
    {"usage", "what was asked makes no sense"},
    {"input", "an input is unreadable or not what it claims to be"},
    {"output", "an output could not be written, and nothing was left behind"},
    {"renderer", "there is nothing to draw with"},
    {"accuracy", "an error that was asked for cannot be met"},
}};

constexpr std::array<Words, enumerators<Remedy>> remedies{{
    {"none", ""},
    {"choose_projection", "set ReadOptions::projection"},
    {"leave_out_from_layout", "leave ReadOptions::layout unset: the file says where its faces lie"},
    {"leave_out_layout", "leave WriteOptions::layout unset"},
    {"leave_out_face", "leave {face} out of the file name"},
    {"drop_channels", "set ReadOptions::drop_channels to leave them behind"},
    {"repair", "set ReadOptions::flaws to FlawPolicy::repair, or call repair() on a map in memory"},
    {"limit_memory", "set ReadOptions::max_memory"},
    {"allow_pixels", "raise ReadOptions::max_pixels"},
    {"choose_format", "set WriteOptions::format, or end the file name in a format's extension"},
    {"choose_plus_z", "use Forward::plus_z"},
    {"clamp_or_deepen", "set WriteOptions::clamp, use less light, or set the depth to Depth::single"},
    {"clamp_or_darken", "set WriteOptions::clamp, use less light, or choose a floating-point format"},
    {"clamp_or_dim", "set clamp (in WriteOptions or PackOptions), or use less light"},
    {"clamp_or_brighten", "set WriteOptions::clamp, use more light, or set the depth to Depth::single"},
    {"clamp_or_light_up", "set WriteOptions::clamp, or use more light"},
    {"choose_space", "set ReadOptions::colour.space"},
    {"choose_linear", "set WriteOptions::colour.space to a linear space, or set WriteOptions::encoded"},
    {"choose_layer", "set ReadOptions::choice.layer"},
    {"leave_out_shadows", "turn shadows off, or use fewer lights"},
    {"force", "set CommitOptions::force, or name a file that may be written"},
    {"find_circle", "crop the photo to the ball: the program's command for photos finds it"},
    {"choose_faces", "set ReadOptions::faces"},
    {"make_levels", "make the levels again by add_levels()"},
    {"make_cube", "make a cube by convert()"},
    {"take_base", "read the picture without its gain map: ReadOptions::choice.headroom = 0"},
    {"make_all_levels", "make all levels down to one texel by add_levels()"},
}};

const Words& of(ErrorCode code) { return codes[number_of("code", code)]; }
const Words& of(Remedy remedy) { return remedies[number_of("remedy", remedy)]; }

}  // namespace

std::string_view name(ErrorCode code) { return of(code).name; }
std::string_view name(Remedy remedy) { return of(remedy).name; }
std::string_view words(ErrorCode code) { return of(code).text; }
std::string_view words(Remedy remedy) { return of(remedy).text; }

}  // namespace envmap
