// What conversion costs, one thread, no files: rows of a Resampler into one buffer. items/s are texels made.
//
//   kernel/FROM/TO      bilinear, equal density, all 25 pairs (same projection: turned, or it would be a copy)
//   filter/NAME/xM      latlong to cube, a result M times as coarse; every filter
//   size/W              latlong W wide to the cube of its density, bilinear: what caches and pages cost
//   apron/P             a PaddedLevel made of the maps of kernel/
//
// JSON: --benchmark_out=FILE; some of them: --benchmark_filter=REGEX.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "envmap/operate/convert.h"
#include "envmap/projection/matching_size.h"
#include "envmap/sample/padded_level.h"

namespace {

using namespace envmap;

constexpr int latlong_height = 1024;  // What the maps of kernel/, filter/ and apron/ are as dense as.
constexpr int max_rows = 192;         // Timed at once: enough to see every part of a map, few enough for 16k maps.
constexpr int run_rows = 16;          // That follow each other, as those of a band do: they share what the caches hold.

int height(Projection p) { return matching_size(Projection::latlong, latlong_height, p); }

// A ramp with 20% of noise: the area filter works for its result as it would on a photograph, not on a plain sky.
void fill(Level& level) {
  std::uint32_t state = 1;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (Colour& c : level.row(face, j)) {
        state = state * 1664525U + 1013904223U;
        const float noise = 0.9F + 0.2F * float(state >> 8) * 0x1p-24F;
        c = Colour(1, 2, 3) * noise * (1 + float(j) / float(level.height()));
      }
}

// The map asked for. Only the last one is kept: the largest takes 1.6 GB.
EnvironmentMap& source(Projection p, int size) {
  static EnvironmentMap map;
  if (map.levels.empty() || map.projection() != p || map.base().height() != size) {
    map.levels.clear();
    fill(map.levels.emplace_back(p, size));
  }
  return map;
}

// Up to max_rows rows in runs, evenly spaced over all faces, and how many texels of the image they hold.
struct Sample {
  std::vector<std::pair<int, int>> rows;  // Face, row.
  std::int64_t texels = 0;
};

Sample sample_of(const Rows& rows) {
  const int all = faces(rows.projection) * rows.size, runs = std::max(1, std::min(all, max_rows) / run_rows);
  const int each = std::min(all / runs, run_rows);
  Sample s;
  for (int run = 0; run < runs; ++run)
    for (int k = 0; k < each; ++k) {
      const auto at = int((run + 0.5) * all / runs) - each / 2 + k;
      s.rows.emplace_back(at / rows.size, at % rows.size);
      const Columns in = columns(rows.projection, rows.size, at % rows.size);
      s.texels += in.end - in.first;
    }
  return s;
}

void time_rows(benchmark::State& state, const EnvironmentMap& from, const ConvertOptions& wanted) {
  const Resampler resampler(from, wanted);
  const Rows rows = resampler.rows();
  const Sample sample = sample_of(rows);
  std::vector<Colour> out(std::size_t(rows.size) * std::size_t(aspect(rows.projection)));
  for (auto _ : state) {
    for (const auto& [face, row] : sample.rows) rows.fill(face, row, out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(std::int64_t(state.iterations()) * sample.texels);
}

void add(const std::string& name, Projection from, int size, const ConvertOptions& wanted) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    time_rows(state, source(from, size), wanted);
  })->Unit(benchmark::kMillisecond);
}

void add_kernels() {
  for (const Projection from : all_projections)
    for (const Projection to : all_projections) {
      ConvertOptions wanted{.to = to, .size = height(to), .filter = Filter::bilinear};
      if (from == to) wanted.rotation = rotation(30, 20, 10);
      add(fmt::format("kernel/{}/{}", name(from), name(to)), from, height(from), wanted);
    }
}

void add_filters() {
  for (const FilterInfo& f : filters())
    for (const int times : {1, 4, 32})
      add(fmt::format("filter/{}/x{}", f.name, times), Projection::latlong, latlong_height,
          {.to = Projection::cube, .size = latlong_height / 2 / times, .filter = f.filter});
  for (const int samples : {2, 4, 8, 16})
    add(fmt::format("filter/bilinear-{}/x4", samples), Projection::latlong, latlong_height,
        {.to = Projection::cube, .size = latlong_height / 8, .filter = Filter::bilinear, .samples = samples});
}

void add_sizes() {
  for (int width = 1024; width <= 16384; width *= 2)
    add(fmt::format("size/{}", width), Projection::latlong, width / 2,
        {.to = Projection::cube, .size = width / 4, .filter = Filter::bilinear});
}

void add_aprons() {
  for (const Projection p : all_projections)
    benchmark::RegisterBenchmark(fmt::format("apron/{}", name(p)).c_str(), [p](benchmark::State& state) {
      const Level& level = source(p, height(p)).base();
      for (auto _ : state) benchmark::DoNotOptimize(PaddedLevel(level).texel(0, 0, 0));
    })->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_kernels();
  add_filters();
  add_sizes();
  add_aprons();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
