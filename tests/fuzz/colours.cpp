// OpenColorIO parses configs; what is asked of them, and what is made of its errors, is ours.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/claims/colour.h"
#include "targets.h"

using namespace envmap;

namespace {

void apply(const ColourTransform& transform) {
  Colour colours[] = {{0, 0.5F, 1}, {65504, 1e-9F, 3e38F}};
  if (transform.apply) transform.apply(colours);
}

template <class Ask>
void ask(const Ask& question) {
  try {
    question();
  } catch (const Error&) {  // Its words become printable where the program tells them.
  }
}

void ask_for_space(const std::string& config, const std::string& space) {
  ask([&] { apply(into_working({config, space, {}}, {})); });
  ask([&] { apply(out_of_working({config, space, {}})); });
  ask([&] { (void)primaries_of(config, space); });
  ask([&] { (void)working_space_for(config, space); });
  ask([&] { (void)space_word(config, space); });
}

}  // namespace

void fuzz_colours(Bytes data) {
  const std::string text(reinterpret_cast<const char*>(data.data()), data.size());
  if (text.find('\n') == text.npos) return ask_for_space("", text);
  const std::string config = "fuzz_colours.ocio";
  std::ofstream(config, std::ios::binary) << text;
  ask([&] {
    const std::vector<std::string> names = colour_spaces(config);
    constexpr std::size_t most = 4;
    for (std::size_t k = 0; k < std::min(most, names.size()); ++k) ask_for_space(config, names[k]);
  });
  ask([&] { apply(into_view({config, {}, {}}, "")); });
}
