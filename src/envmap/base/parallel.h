/// @file
/// Rows of a level in parallel; results never depend on the number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "envmap/base/progress.h"

namespace envmap {

/// f(face, row) for every row of a map of `faces` x `height` rows.
template <class F>
void for_each_row(int faces, int height, const Progress& progress, F&& f) {
  const int rows = faces * height, report = std::max(1, rows / 200);
  std::atomic<int> done{0};
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, 4), [&](const tbb::blocked_range<int>& range) {
    for (int k = range.begin(); k < range.end(); ++k) {
      f(k / height, k % height);
      if (progress && ++done % report == 0) progress(double(done) / rows);
    }
  });
}

/// One result a row, then combined from the first row to the last: the order that makes sums reproducible.
template <class Result, class F>
std::vector<Result> map_rows(int height, F&& f) {
  std::vector<Result> results(static_cast<std::size_t>(height));
  tbb::parallel_for(0, height, [&](int j) { results[j] = f(j); });
  return results;
}

/// The same of all rows of a level, face after face: f(result, face, row) fills a new result.
template <class Result, class L, class F>
std::vector<Result> map_level(L& level, F&& f) {
  return map_rows<Result>(level.faces() * level.height(), [&](int k) {
    Result result{};
    level.trim();
    f(result, k / level.height(), k % level.height());
    return result;
  });
}

}  // namespace envmap
