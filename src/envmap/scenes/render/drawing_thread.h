/// @file
/// OpenGL in a thread of its own, where its context and programs stay from one map to the next.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "envmap/base/run.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/renderer.h"

namespace envmap {

/// What of OpenGL outlasts a map. It lives in one thread.
struct DrawingSession {
  explicit DrawingSession(ContextKind kind) : context(kind) {}

  Context context;
  std::shared_ptr<ProgramCache> programs = std::make_shared<ProgramCache>();
  std::optional<Renderer> renderer = {};                ///< Without mirrors.
  std::shared_ptr<const Environment> lit_by = nullptr;  ///< The renderer's.
};

/// The context that is current in the caller's thread stays current. All such threads of a process take turns, since
/// GL's functions (gl.h) are one context's.
class DrawingThread {
 public:
  explicit DrawingThread(ContextKind kind);
  ~DrawingThread();
  DrawingThread(const DrawingThread&) = delete;
  DrawingThread& operator=(const DrawingThread&) = delete;

  [[nodiscard]] ContextKind kind() const { return kind_; }

  /// Does the work there, and waits for it. @param progress may be empty. @throws what the work throws, Cancelled while
  /// it waits for its turn, RendererError where there is no context.
  void run(const std::function<void(DrawingSession&)>& work, const Progress& progress);

 private:
  void serve();

  ContextKind kind_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void(std::unique_ptr<DrawingSession>&)> next_;  // Empty: nothing to do.
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace envmap
