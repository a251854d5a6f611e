// What prefiltered maps cost, in counted steps: a change that takes more of them shows here, without a clock.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <random>
#include <string>

#include "envmap/prefilter/prefilter.h"

namespace envmap::work_counters_test {
namespace {

// Noise over a sky and a darker ground, and a sun.
EnvironmentMap landscape(Projection projection, int size) {
  EnvironmentMap map;
  map.levels.emplace_back(projection, size);
  std::mt19937 random(11);
  Level& level = map.base();
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (Colour& c : level.row(face, j))
        for (int k = 0; k < 3; ++k) c[k] = (j < size / 2 ? 1.F : 0.2F) * (0.5F + float(random() % 1000) / 1000);
  *level.texel(0, level.width() / 3, size / 3) = Colour(3000, 2800, 2500);
  return map;
}

using Steps = std::map<std::string, double>;  // In thousands.

struct Job {
  Projection from;
  int rows;
  PrefilterOptions wanted;
  Method method;
  Steps steps;
};

Steps steps_of(const Prefiltered& done) {
  Steps steps;
  for (const StepCount& s : done.work) steps[std::string(s.step)] = 1e-3 * double(s.count);
  return steps;
}

std::string words(const Prefiltered& done) {
  std::string all = "Method::" + std::string(method_names[std::size_t(done.method)]) + ", {";
  for (const auto& [step, count] : steps_of(done)) all += "{\"" + step + "\", " + std::to_string(count) + "}, ";
  return all + "}";
}

const Job jobs[] = {
#include "numeric/work_table.inc"
};

TEST(Work, JobsTakeTheirSteps) {
  for (const Job& job : jobs) {
    const Prefiltered done = Prefilterer(landscape(job.from, job.rows)).make(job.wanted);
    const Steps found = steps_of(done);
    const std::string which = std::to_string(&job - jobs) + ": " + words(done);
    EXPECT_EQ(done.method, job.method) << which;
    EXPECT_EQ(found.size(), job.steps.size()) << which;
    for (const auto& [step, count] : job.steps) {
      ASSERT_TRUE(found.contains(step)) << which;
      EXPECT_NEAR(found.at(step), count, 0.05 * count) << which;
    }
  }
}

TEST(Work, ThreadsTakeTheSameSteps) {
  for (const Job& job : {jobs[0], jobs[6], jobs[10]}) {
    const EnvironmentMap map = landscape(job.from, job.rows);
    const auto with_threads = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return steps_of(Prefilterer(map).make(job.wanted));
    };
    EXPECT_EQ(with_threads(1), with_threads(2));
  }
}

}  // namespace
}  // namespace envmap::work_counters_test
