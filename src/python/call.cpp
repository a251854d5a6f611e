#include "call.h"

#include <ImfThreading.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stop_token>
#include <thread>

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;
using envmap::Cancelled;

constexpr auto between_signals = 50ms, time_to_end = 300ms, time_to_clean_up = 1000ms;

// Tasks that were left behind, and still run.
class LeftBehind {
 public:
  void add() {
    const std::lock_guard lock(mutex_);
    ++count_;
  }
  void remove() {
    const std::lock_guard lock(mutex_);
    --count_;
    fewer_.notify_all();
  }
  bool wait_for(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return fewer_.wait_for(lock, time, [&] { return count_ == 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable fewer_;
  int count_ = 0;
};
LeftBehind& left_behind() {
  static auto& all = *new LeftBehind;  // Tasks may end after the destructors of statics.
  return all;
}

// Ends the process where a task still runs: destructors of statics would take from it what it uses. Python has ended
// before, and so have handlers that were registered later.
void leave_tasks(int status, void*) {
  if (left_behind().wait_for(time_to_clean_up)) return;
  std::fflush(nullptr);
  ::_exit(status);
}

void leave_behind() {
  static const int registered = ::on_exit(leave_tasks, nullptr);
  (void)registered;
  left_behind().add();
}

std::atomic<int> running = 0;  // Tasks, those that were left behind among them.

// A task and the call that waits for it: each has a thread.
class Work {
 public:
  // ---- the task's thread ----

  void run_operation(const std::function<void(const envmap::Run&)>& task, bool tells) {
    std::exception_ptr thrown;
    try {
      envmap::Run run{.stop = stop_.get_token()};
      if (tells) run.progress = [this](double part) { tell(part); };
      task(run);
    } catch (...) {
      thrown = std::current_exception();
    }
    --running;
    const std::lock_guard lock(mutex_);
    thrown_ = thrown;
    done_ = true;
    changed_.notify_all();
    if (is_left_) left_behind().remove();
  }

  // ---- the calling thread ----

  // @return the part done where that was told; nothing after a while, or where the task has ended.
  std::optional<double> next() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, between_signals, [&] { return done_ || told_; });
    return told_;
  }
  void answer() {
    const std::lock_guard lock(mutex_);
    told_.reset();
    changed_.notify_all();
  }
  bool is_done() {
    const std::lock_guard lock(mutex_);
    return done_;
  }
  void stop() {
    stop_.request_stop();
    answer();
  }
  // @return whether the task ended in time. Otherwise it is left behind.
  bool ends_soon() {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, time_to_end, [&] { return done_; })) return true;
    is_left_ = true;
    leave_behind();
    return false;
  }
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  // Waits until the calling thread has told Python.
  void tell(double part) {
    std::unique_lock lock(mutex_);
    if (stop_.stop_requested()) throw Cancelled();
    told_ = part;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !told_; });
    if (stop_.stop_requested()) throw Cancelled();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::stop_source stop_;
  std::optional<double> told_;
  bool done_ = false, is_left_ = false;
  std::exception_ptr thrown_;
};

// What a call of Python raises.
using Raised = std::optional<py::error_already_set>;

Raised raised_by(const std::function<void()>& call) {
  const py::gil_scoped_acquire own;
  try {
    call();
  } catch (py::error_already_set& e) {
    return std::move(e);
  }
  return {};
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

// Waits without the GIL. @return whether the task has ended. @param raised what ended it.
bool wait_for(Work& work, const py::object& progress, Raised& raised) {
  const py::gil_scoped_release others;
  while (!work.is_done()) {
    if (const std::optional<double> part = work.next()) {
      if (!raised) raised = raised_by([&] { progress(*part); });
      raised ? work.stop() : work.answer();
    } else if (!work.is_done()) {
      if (Raised signal = raised_by(check_signals)) {
        raised = std::move(signal);
        work.stop();
        return work.ends_soon();
      }
    }
  }
  return true;
}

}  // namespace

void run_task(const py::object& progress, std::function<void(const envmap::Run&)> task) {
  const auto work = std::make_shared<Work>();
  std::thread thread([work, task = std::move(task), tells = !progress.is_none()] { work->run_operation(task, tells); });
  ++running;
  Raised raised;
  if (wait_for(*work, progress, raised)) {
    const py::gil_scoped_release others;
    thread.join();
  } else {
    thread.detach();
  }
  if (raised) throw std::move(*raised);
  work->rethrow();
}

void add_before_fork(py::module_& module) {
  // OpenEXR keeps threads, which a forked process would wait for without having them. The next file starts them again.
  module.def("before_fork", [] {
    if (running == 0) Imf::setGlobalThreadCount(0);
  });
}

}  // namespace envmap_python
