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
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE})
      if (std::signal(signal, remove_pending) == SIG_IGN) std::signal(signal, SIG_IGN);
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
