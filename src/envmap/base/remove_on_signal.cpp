#include "envmap/base/remove_on_signal.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

namespace envmap {
namespace {

// A handler may only touch atomics and make system calls.
std::array<std::atomic<const char*>, 256> pending;

extern "C" void remove_pending(int signal) {
  for (auto& slot : pending)
    if (const char* name = slot.load()) ::unlink(name);
  for (auto& slot : pending)
    if (const char* name = slot.load()) ::rmdir(name);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void handle_signals() {
  static const bool installed = [] {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ})
      // What the program around the library does with a signal, it goes on doing: Python's Ctrl-C is an exception.
      if (const auto before = std::signal(signal, remove_pending); before != SIG_DFL) std::signal(signal, before);
    return true;
  }();
  (void)installed;
}

}  // namespace

void remove_on_signal(const char* name) {
  handle_signals();
  for (auto& slot : pending) {
    const char* empty = nullptr;
    if (slot.compare_exchange_strong(empty, name)) return;
  }
}

void keep_on_signal(const char* name) {
  for (auto& slot : pending) {
    const char* mine = name;
    if (slot.compare_exchange_strong(mine, nullptr)) return;
  }
}

}  // namespace envmap
