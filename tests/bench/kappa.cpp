// How far multilevel sums are off of one light, over the bound that they state: what the constants of
// docs/explanation/prefilter-multilevel.md rest on, which bound the error of every map. Measured over random lights of
// one texel, at a pole, at the equator and anywhere, in random directions, a third of them near its horizon.
// The truth is the exact sum.
//
//   kappa [LIGHTS [LATLONG CUBE [LEAST MOST]]]       lights, sizes of the sources, and which parameters of lobes
//                                                    (of the narrowest Phong lobes of a grid: its rows;
//                                                    of panels of a cube: their number)
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/multilevel/multilevel.h"
#include "envmap/prefilter/near_field/point_rules.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/source_cube.h"
#include "narrowest_phong.h"

namespace {

using namespace envmap;
using namespace envmap::prefiltering;

class Random {
 public:
  double part() { return double(engine_() >> 11) * 0x1p-53; }
  // @param width of a power: one direction of three is in its tail. 0: none.
  Direction round(const Direction& light, double width) {
    const int kind = pick_++ % 3;
    double angle = std::pow(10, -3.5 + 3.8 * part());
    if (kind == 0) angle = pi * (0.5 + 0.04 * (part() - 0.5));
    if (kind == 1 && width > 0) angle = width * (4 + 2.5 * part());
    angle = std::min(pi, angle);
    const Direction side = unit(glm::cross(light, std::abs(light.y) < 0.9 ? Direction(0, 1, 0) : Direction(1, 0, 0)));
    const double turn = 2 * pi * part();
    return unit(std::cos(angle) * light +
                std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * glm::cross(light, side)));
  }

 private:
  std::mt19937_64 engine_{5};
  int pick_ = 0;
};

// Of one light: the largest part of its bound that the error comes to.
double error_of(const Level& map, const Direction& light, const LobeFormula& lobe, const MultilevelPlan& plan,
                double error, Random& random) {
  const double mean = mean_radiance(map);
  const SourceGrids grids(map, mean, Colour(0), plan.finest());
  const std::optional<Level> fine = refined(map);
  const Level& small = fine ? *fine : map;
  const PrefixSums prefix_sums(map, mean, Colour(0), 3, error);
  std::vector<Direction> some(2000);
  const bool power = !plan.steps.empty() ? plan.steps[0].kernel.kind == LevelKernel::Kind::power
                                         : plan.near_field && plan.near_field->kind == LevelKernel::Kind::power;
  for (Direction& d : some) d = random.round(light, power ? plan.width : 0);
  std::vector<MultilevelSum> sums(some.size());
  const MultilevelSource source{small, grids, &prefix_sums, mean, Colour(0)};
  multilevel_sums(plan, source, smooth_field(plan, source, 2048), some, sums);
  const std::vector<Flux> truth = exact_prefilter(map, lobe, some);
  double worst = 0;
  for (std::size_t k = 0; k < some.size(); ++k)
    worst = std::max(worst, std::abs(sums[k].value.x - truth[k].x) / std::max(truth[k].x, 1e-3 * mean) / sums[k].bound);
  return worst;
}

// The largest part of its bound, of lights in so many places.
double worst_of(const LobeFormula& lobe, const MultilevelPlan& plan, double error, Projection projection, int size,
                int lights) {
  Random random;
  double worst = 0;
  for (int n = 0; n < lights; ++n) {
    Level map(projection, size);
    const int j = n == 0 ? 0 : n == 1 ? size / 2 : int(random.part() * size), i = int(random.part() * map.width());
    *map.texel(0, i, j) = Colour(1e9F, 0, 0);
    std::vector<Direction> light(1);
    texel_directions(projection, size, 0, j, i, light);
    worst = std::max(worst, error_of(map, light[0], lobe, plan, error, random));
  }
  return worst;
}

constexpr double errors[] = {1e-3, 4e-4, 1e-4};

void print_line(LobeShape shape, double parameter, Projection projection, int size, int lights) {
  std::string line =
      fmt::format("{:6} {:<7g} {:7} {:4}:", lobe_shape_names[std::size_t(shape)], parameter, name(projection), size);
  const int max_rows = finest_rows(Level(projection, size));
  for (const double error : errors) {
    const LobeFormula lobe = formula_of(Lobe(shape, parameter));
    const bool power = shape == LobeShape::phong || shape == LobeShape::blinn_phong;
    const auto plan = multilevel_plan(lobe, error, std::min(2048, power ? 2 * max_rows : max_rows), projection);
    line += plan ? fmt::format("  {:g} {:.2f}", error, worst_of(lobe, *plan, error, projection, size, lights))
                 : fmt::format("  {:g} no bound", error);
  }
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

// The narrowest Phong lobes that a grid of so many rows serves: of them, the tails are hardest. Nothing where the
// source has too few texels for such a grid.
void print_narrowest(int rows, Projection projection, int size, int lights) {
  const int max_rows = std::min(2048, 2 * finest_rows(Level(projection, size)));
  std::string line = fmt::format("phong, {:4} rows {:7} {:4}:", rows, name(projection), size);
  for (const double error : errors) {
    const Phong lobe{narrowest_phong(rows, error, max_rows, projection)};
    const auto plan = multilevel_plan(lobe, error, max_rows, projection);
    if (!plan || plan->finest() != rows) return;
    line += fmt::format("  {:g} ({:.0f}) {:.2f}", error, lobe.exponent,
                        worst_of(lobe, *plan, error, projection, size, lights));
  }
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

// Phong lobes whose texels of a cube are divided into panels just small enough.
void print_panels(int panels, int size, int lights) {
  const double side = 2.0 / size;
  std::string line = fmt::format("phong, {} panels cube {:4}:", panels, size);
  for (const double error : errors) {
    double least = 2.1e3, most = 1e8;  // As narrow as panels serve.
    const auto plan_at = [&](double exponent) {
      return multilevel_plan(Phong{exponent}, error, 256, Projection::cube);
    };
    while (most / least > 1.001) {
      const double middle = std::sqrt(least * most);
      const auto plan = plan_at(middle);
      const bool more = plan->near_field && panels_on_face(*plan->near_field, side).value_or(1000) > panels;
      (more ? most : least) = middle;
    }
    line += fmt::format("  {:g} ({:.0f}) {:.2f}", error, least,
                        worst_of(Phong{least}, *plan_at(least), error, Projection::cube, size, lights));
  }
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const auto given = [&](int k, double otherwise) { return argc > k ? std::atof(argv[k]) : otherwise; };
  const int lights = int(given(1, 6));
  const double least = given(4, 0), most = given(5, 1e9);
  const auto print = [&](LobeShape shape, double parameter, Projection projection, int size, int count) {
    if (parameter >= least && parameter <= most) print_line(shape, parameter, projection, size, count);
  };
  for (const auto& [projection, size] :
       {std::pair{Projection::latlong, int(given(2, 512))}, std::pair{Projection::cube, int(given(3, 256))}}) {
    for (const double roughness : {0.001, 0.01, 0.02, 0.05, 0.08, 0.1, 0.12, 0.15, 0.2, 0.3, 0.5, 0.8})
      print(LobeShape::ggx, roughness, projection, size, lights);
    for (const double exponent : {4.0, 6.0, 20.0, 300.0, 1e5, 1e6, 1e8})
      print(LobeShape::phong, exponent, projection, size, lights);
    for (const int rows : {512, 1024, 2048})
      if (rows >= least && rows <= most) print_narrowest(rows, projection, size, lights);
    for (const int panels : {1, 2, 3})
      if (projection == Projection::cube && panels >= least && panels <= most) print_panels(panels, size, lights);
    for (const double exponent : {2.0, 6.0, 40.0, 1000.0, 12000.0, 1e6})
      print(LobeShape::blinn_phong, exponent, projection, size, lights);
  }
}
