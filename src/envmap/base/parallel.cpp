#include "envmap/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>

#include "envmap/base/stop_point.h"

namespace envmap {

namespace {

// A loop in a context of its own, below that of the operation that it is a part of (with_stop()): oneTBB begins no
// further step of it once the operation is asked to stop, and returns as if all were done.
template <class Loop>
void stoppable(const Loop& loop) {
  tbb::task_group_context context;
  loop(context);
  if (context.is_group_execution_cancelled()) throw Cancelled();
}

}  // namespace

void parallel_for(int count, const std::function<void(int k)>& f) {
  stoppable([&](auto& context) { tbb::parallel_for(0, count, f, tbb::auto_partitioner(), context); });
}

void parallel_ranges(int count, int least, const std::function<void(int begin, int end)>& f) {
  using Range = tbb::blocked_range<int>;
  stoppable([&](auto& context) {
    tbb::parallel_for(
        Range(0, count, std::size_t(least)), [&](const Range& part) { f(part.begin(), part.end()); },
        tbb::auto_partitioner(), context);
  });
}

void for_each_row(int faces, int height, const Progress& progress, const std::function<void(int face, int row)>& f) {
  const int rows = faces * height, report = std::max(1, rows / 200);
  std::atomic<int> done{0};
  parallel_ranges(rows, 4, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      stop_point();
      f(k / height, k % height);
      if (progress && ++done % report == 0) progress(double(done) / rows);
    }
  });
}

void stop_point() {
  if (tbb::is_current_task_group_canceling()) throw Cancelled();
}

void with_threads(int threads, const std::function<void()>& work) {
  if (threads == 0) return work();
  tbb::task_arena arena(threads);
  arena.execute(work);
}

void with_stop(const std::stop_token& stop, const std::function<void()>& work) {
  if (!stop.stop_possible()) return work();
  tbb::task_group_context context;
  const std::stop_callback cancel(stop, [&context] { context.cancel_group_execution(); });
  tbb::task_group group(context);
  bool done = false;
  group.run_and_wait([&] {
    work();
    done = true;
  });
  if (!done) throw Cancelled();
}

void isolate_tasks(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

void overlap(const std::function<void()>& ahead, const std::function<void()>& work) {
  tbb::task_group group;
  group.run(ahead);
  try {
    work();
  } catch (...) {
    group.wait();
    throw;
  }
  if (group.wait() == tbb::canceled) throw Cancelled();
}

int thread_limit() { return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

}  // namespace envmap
