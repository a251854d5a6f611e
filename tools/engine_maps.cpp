#include "engine_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/window.h"

namespace tools {
namespace {

using namespace envmap;

// A cube with X or Z negated: the two faces of that axis change places, and images are mirrored along the other axes' faces:
// left to right but for the faces of Y under Z, which has their up there.
Rows mirrored(const Rows& rows, Mirror mirror) {
  Rows turned = rows;
  turned.fill = [rows, mirror](int face, int row, std::span<Colour> out) {
    const int first = mirror == Mirror::x ? 0 : 4;
    const bool upside_down = mirror == Mirror::z && (face == 2 || face == 3);
    rows.fill(face / 2 * 2 == first ? face ^ 1 : face, upside_down ? rows.size - 1 - row : row, out);
    if (!upside_down) std::ranges::reverse(out);
  };
  return turned;
}

}  // namespace

MapMaker::MapMaker(const EnvironmentMap& source, std::optional<int> size, std::optional<int> chain_size, const Common& common)
    : source_(source), size_(size), chain_size_(chain_size), common_(common) {}

MadeMap MapMaker::environment(const Frame& frame, std::optional<int> size) const {
  MadeMap made;
  made.rows.push_back(Resampler(source_, {.to = frame, .size = size}).rows());
  return made;
}

MadeMap MapMaker::chain(const EngineMap& wanted) {
  const Chain& chain = *wanted.chain;
  MadeMap made{.facts = {{"lobe", "ggx"}}};
  const int base = chain_size_.value_or(chain.size);
  const int possible = std::bit_width(static_cast<unsigned>(base)), count = chain.levels > 0 ? chain.levels : possible;
  if (count > possible) throw UsageError(fmt::format("--chain-size {}: {} has {} levels", base, wanted.file, count));
  for (int k = 0; k < count; ++k) {
    const double roughness = chain.roughness(k, count, base);
    const int size = base >> k;
    made.facts["roughness"] += fmt::format("{}{:g}", k == 0 ? "" : ",", roughness);
    if (roughness == 0) {
      made.levels.levels.push_back(level_of(environment(wanted.frame, size).rows.front()));
      continue;
    }
    const Prefilter lobe{.shape = Shape::ggx, .parameter = roughness, .to = wanted.frame.projection, .size = size, .max_error = 2e-3};
    const Progress progress = progress_line(common_, fmt::format("bake roughness {:.2f}", roughness));
    made.levels.levels.push_back(std::move(prepared().make(lobe, progress).map.base()));
  }
  made.rows = all_rows_of(made.levels);
  if (chain.harmonics) made.pairs["sh"] = filament_harmonics(source_, common_);
  return made;
}

MadeMap MapMaker::diffuse(const EngineMap& wanted) {
  MadeMap made{.facts = {{"lobe", "diffuse"}}};
  const Prefilter lobe{.to = wanted.frame.projection, .size = wanted.diffuse, .forward = wanted.frame.forward};
  made.levels = prepared().make(lobe, progress_line(common_, "bake diffuse")).map;
  made.rows = all_rows_of(made.levels);
  return made;
}

MadeMap MapMaker::make(const EngineMap& wanted) {
  MadeMap made = wanted.chain ? chain(wanted) : wanted.diffuse > 0 ? diffuse(wanted) : environment(wanted.frame, size_);
  if (wanted.mirror != Mirror::none)
    for (Rows& rows : made.rows) rows = mirrored(rows, wanted.mirror);
  return made;
}

const PrefilterSource& MapMaker::prepared() {
  if (!prepared_) prepared_ = std::make_unique<PrefilterSource>(source_);
  return *prepared_;
}

std::string filament_harmonics(const EnvironmentMap& source, const Common& common) {
  Harmonics h = project(source, 2, progress_line(common, "bake harmonics"));
  scale_degrees(h, laplacian_window(2, weakest_window(h).lambda));
  std::vector<double> factors = irradiance_factors(2);
  for (double& f : factors) f /= pi;
  scale_degrees(h, factors);
  // Normalisations of harmonics.h. Their polar axis is Y, Filament's Z: with x^2 + y^2 + z^2 = 1,
  // a (3y^2 - 1) + b (z^2 - x^2) = (b - a)/2 (3z^2 - 1) - (3a + b)/2 (x^2 - y^2).
  std::array<Flux, 9> c;
  for (std::size_t k = 0; k < 9; ++k) c[k] = h.coefficients[k];
  constexpr double n0 = 0.28209479177387814, n1 = 0.4886025119029199, n2 = 1.0925484305920792, n20 = 0.31539156525252005;
  const Flux a = n20 * c[6], b = 0.5 * n2 * c[8];
  const Flux out[] = {n0 * c[0],  n1 * c[2], n1 * c[3], n1 * c[1], n2 * c[5], n2 * c[7], 0.5 * (b - a), n2 * c[4],
                      -0.5 * (3.0 * a + b)};
  std::string text;
  for (const Flux& f : out) text += fmt::format("{:.9g} {:.9g} {:.9g}\n", f.x, f.y, f.z);
  return text;
}

}  // namespace tools
