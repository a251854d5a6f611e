#include "engine_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "engine_harmonics.h"
#include "envmap/base/error.h"
#include "envmap/operate/convert.h"

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
  if (chain.irradiance != IrradianceForm::none)
    made.pairs.insert(harmonics_pair(chain.irradiance, irradiance_polynomial(source_, progress_line(common_, "bake harmonics"))));
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

}  // namespace tools
