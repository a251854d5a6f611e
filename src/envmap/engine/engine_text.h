// What an engine's users read (text/NAME.txt), and the files beside its maps (files/).
#pragma once

#include <string_view>

namespace envmap {

/// A file of text/ or files/, in the library itself. @return empty where there is none.
/// text/NAME.txt begins with lines "orientation: ..." (more about the orientation, if there is more) and "light: ..."
/// (how diffuse and rough light is made). The rest is what to do with the folder.
std::string_view engine_text(std::string_view name);

}  // namespace envmap
