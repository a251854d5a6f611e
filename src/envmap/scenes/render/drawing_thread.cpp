#include "envmap/scenes/render/drawing_thread.h"

#include <future>

#include "envmap/base/turn.h"

namespace envmap {
namespace {

// Whose turn it is to call GL.
std::timed_mutex& opengl_in_use() {
  static std::timed_mutex mutex;
  return mutex;
}

}  // namespace

DrawingThread::DrawingThread(ContextKind kind) : kind_(kind), thread_([this] { serve(); }) {}

DrawingThread::~DrawingThread() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void DrawingThread::serve() {
  std::unique_ptr<DrawingSession> session;
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return next_ || ends_; });
    if (!next_) break;
    std::exchange(next_, nullptr)(session);
  }
  if (!session) return;
  const std::lock_guard turn(opengl_in_use());
  session->context.load_functions();
  session.reset();
}

void DrawingThread::run(const std::function<void(DrawingSession&)>& work, const Progress& progress) {
  const auto turn = wait_for_turn(opengl_in_use(), progress);
  const auto done = std::make_shared<std::promise<void>>();
  {
    const std::lock_guard lock(mutex_);
    next_ = [&work, done, this](std::unique_ptr<DrawingSession>& session) {
      try {
        if (session)
          session->context.load_functions();
        else
          session = std::make_unique<DrawingSession>(kind_);
        work(*session);
        done->set_value();
      } catch (...) {
        done->set_exception(std::current_exception());
      }
    };
  }
  changed_.notify_one();
  done->get_future().get();
}

}  // namespace envmap
