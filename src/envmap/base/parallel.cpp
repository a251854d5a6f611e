#include "envmap/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>

namespace envmap {

void parallel_for(int count, const std::function<void(int k)>& f) { tbb::parallel_for(0, count, f); }

void parallel_ranges(int count, int least, const std::function<void(int begin, int end)>& f) {
  using Range = tbb::blocked_range<int>;
  tbb::parallel_for(Range(0, count, std::size_t(least)), [&](const Range& part) { f(part.begin(), part.end()); });
}

void for_each_row(int faces, int height, const Progress& progress, const std::function<void(int face, int row)>& f) {
  const int rows = faces * height, report = std::max(1, rows / 200);
  std::atomic<int> done{0};
  parallel_ranges(rows, 4, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      f(k / height, k % height);
      if (progress && ++done % report == 0) progress(double(done) / rows);
    }
  });
}

void with_threads(int threads, const std::function<void()>& work) {
  if (threads == 0) return work();
  tbb::task_arena arena(threads);
  arena.execute(work);
}

void isolated(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

void run_beside(const std::function<void()>& ahead, const std::function<void()>& work) {
  tbb::task_group group;
  group.run(ahead);
  try {
    work();
  } catch (...) {
    group.wait();
    throw;
  }
  group.wait();
}

int thread_limit() { return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

}  // namespace envmap
