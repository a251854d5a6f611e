/// @file
/// Work in parallel. Results never depend on the number of threads.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "envmap/base/run.h"

namespace envmap {

/// f(k) for every k from 0 to `count` - 1.
void parallel_for(int count, const std::function<void(int k)>& f);

/// f(begin, end) for parts of 0 to `count`. @param least a part is divided only where it is larger.
void parallel_ranges(int count, int least, const std::function<void(int begin, int end)>& f);

/// f(face, row) for every row of a map of `faces` x `height` rows.
void for_each_row(int faces, int height, const Progress& progress, const std::function<void(int face, int row)>& f);

/// One result a row, then combined from the first row to the last: the order that makes sums reproducible.
template <class Result, class F>
std::vector<Result> map_rows(int height, F&& f) {
  std::vector<Result> results(static_cast<std::size_t>(height));
  parallel_for(height, [&](int j) { results[std::size_t(j)] = f(j); });
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

/// Calls work() with so many threads. @param threads 0: as many as the caller has.
void with_threads(int threads, const std::function<void()>& work);

/// Calls work(). Once a stop is requested, the loops in it begin no further step. @throws Cancelled where work() was
/// left unfinished by that.
void with_stop(const std::stop_token& stop, const std::function<void()>& work);

/// Calls work(), for which a lock may be held: this thread takes no task from outside while it waits.
void isolate_tasks(const std::function<void()>& work);

/// Calls ahead() while work() runs in this thread. @throws what work throws, else what ahead does, once both ended.
void overlap(const std::function<void()>& ahead, const std::function<void()>& work);

/// How many threads may work at once.
int thread_limit();

}  // namespace envmap
