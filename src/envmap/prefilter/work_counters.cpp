// Each thread has counters of its own, which outlive it: counting takes no lock.
#include "envmap/prefilter/work_counters.h"

#include <deque>
#include <mutex>

namespace envmap::prefiltering {
namespace {
struct Slot {
  alignas(64) WorkCounters done{};
};
std::mutex lock;
std::deque<Slot>& slots() {
  static std::deque<Slot> all;  // Of threads that have ended, too.
  return all;
}
WorkCounters& new_slot() {
  const std::lock_guard guard(lock);
  return slots().emplace_back().done;
}
}  // namespace

WorkCounters& work_of_this_thread() {
  thread_local WorkCounters& mine = new_slot();
  return mine;
}

WorkDone work_done() {
  const std::lock_guard guard(lock);
  WorkDone sum{};
  for (const Slot& s : slots())
    for (std::size_t k = 0; k < kinds_of_work; ++k) sum[k] += s.done[k].load(std::memory_order_relaxed);
  return sum;
}

}  // namespace envmap::prefiltering
