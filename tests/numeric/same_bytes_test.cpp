// The same bytes for any number of threads and, of what has kernels of its own, for every instruction set: a row for
// each operation of the library. What the program writes, and the ray caster by its commands: tests/same_bytes.py.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "envmap/operate/atmosphere.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/levels.h"
#include "envmap/prefilter/brdf_table.h"
#include "envmap/prefilter/prefilter.h"
#include "every_target.h"
#include "numeric/landscape.h"

namespace envmap::same_bytes_test {
namespace {

using Bytes = std::string;

void add(Bytes& bytes, std::span<const Colour> texels) {
  bytes.append(reinterpret_cast<const char*>(texels.data()), texels.size_bytes());
}
Bytes bytes_of(const EnvironmentMap& map) {
  Bytes bytes;
  for (const Level& level : map.levels)
    for (int face = 0; face < level.faces(); ++face)
      for (int j = 0; j < level.height(); ++j) add(bytes, level.row(face, j));
  return bytes;
}
Bytes bytes_of(const std::vector<Colour>& table) {
  Bytes bytes;
  add(bytes, table);
  return bytes;
}

struct Job {
  std::string name;
  std::function<Bytes()> make;
  bool on_targets = true;  // Else tests/unit holds the kernels to one another.
};

// As many threads as that, however few cores there are.
Bytes by_threads(int threads, const Job& job) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
  tbb::task_arena arena(threads);
  return arena.execute(job.make);
}

void expect_same(const Job& job) {
  const Bytes one = by_threads(1, job);
  EXPECT_FALSE(one.empty()) << job.name;
  for (const int threads : {2, 5}) EXPECT_TRUE(by_threads(threads, job) == one) << job.name << ", " << threads;
  if (job.on_targets)
    on_every_target([&](const char* target) { EXPECT_TRUE(job.make() == one) << job.name << ", " << target; });
}

class EachProjection : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(SameBytes, EachProjection, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachProjection, OfLevelsAndConversions) {
  std::vector<Job> jobs{{"levels",
                         [] {
                           EnvironmentMap map = generate(Directions{}, GetParam(), 99);
                           add_levels(map);
                           return bytes_of(map);
                         },
                         false}};
  const EnvironmentMap source = generate(Sun{.radius_degrees = 5}, GetParam(), 24);
  for (const Projection to : all_projections)
    for (const Filter filter :
         {Filter::bilinear, Filter::bicubic, Filter::trilinear, Filter::sat, Filter::ewa, Filter::area})
      jobs.push_back(
          {std::string(name(filter)) + " to " + name(to),
           [&source, to, filter] { return bytes_of(convert(source, {.to = to, .size = 20, .filter = filter})); },
           false});
  for (const Job& job : jobs) expect_same(job);
}

// The source is large enough for blocks of two by two texels.
TEST(SameBytes, OfPrefilteredMapsAndTables) {
  const EnvironmentMap source = numeric_tests::landscape(Projection::cube, 160);
  const auto prefiltered = [&source](const PrefilterOptions& p) {
    return Job{std::string(lobe_shape_names[std::size_t(p.lobe.shape())]) + " " +
                   std::string(method_names[std::size_t(p.method)]),
               [&source, p] { return bytes_of(Prefilterer(source).make(p).map); }};
  };
  const PrefilterOptions phong{.lobe = Lobe::phong(60), .size = 12};
  PrefilterOptions tree = phong, exact = phong;
  tree.method = Method::treecode, exact.method = Method::exact, exact.size = 2;
  for (const Job& job :
       {prefiltered({.lobe = Lobe::diffuse(), .size = 12}), prefiltered(phong), prefiltered(tree), prefiltered(exact),
        prefiltered({.lobe = Lobe::ggx(0.35), .size = 12}),
        Job{"table of ggx", [] { return bytes_of(brdf_table(13)); }},
        Job{"table of charlie", [] { return bytes_of(sheen_table(13)); }},
        Job{"sky with air", [] { return bytes_of(generate(Atmosphere{}, Projection::cube, 16).map); }, false}})
    expect_same(job);
}

}  // namespace
}  // namespace envmap::same_bytes_test
