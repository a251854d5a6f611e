#include "envmap/prefilter/work.h"

#include <deque>
#include <mutex>

namespace envmap::prefiltering {
namespace {
struct Slot {
  alignas(64) WorkDone done{};
};
std::mutex lock;
std::deque<Slot>& slots() {
  static std::deque<Slot> all;  // Of threads that have ended, too.
  return all;
}
WorkDone& new_slot() {
  const std::lock_guard guard(lock);
  return slots().emplace_back().done;
}
}  // namespace

WorkDone& work_here() {
  thread_local WorkDone& mine = new_slot();
  return mine;
}

WorkDone work_done() {
  const std::lock_guard guard(lock);
  WorkDone sum{};
  for (const Slot& s : slots())
    for (std::size_t k = 0; k < kinds_of_work; ++k) sum[k] += s.done[k];
  return sum;
}

}  // namespace envmap::prefiltering
