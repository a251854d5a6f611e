/// @file
/// A current OpenGL 4.5 core context without a window: through EGL on a graphics card or the processor, or through
/// OSMesa on the processor. Both libraries are opened when they are asked for; the program is linked to neither.
#pragma once

#include <memory>
#include <string>

#include "envmap/scenes/render/drawing_method.h"

namespace envmap {

/// Whether `automatic` would draw on a graphics card. Where EGL lists one, it opens a context and closes it: no other
/// may be current.
bool finds_graphics_card();

/// Current on the thread that made it, from then on; nothing of GL may be called on another one. GL's functions (gl.h)
/// belong to the context made last: where there are several, one draws at a time, after load_functions().
class Context {
 public:
  /// @param kind `automatic`: a graphics card through EGL, else OSMesa, else the processor through EGL.
  /// @throws RendererError with the reason and what to install.
  explicit Context(ContextKind kind);
  ~Context();

  /// The library, and what GL says of the renderer and its version.
  [[nodiscard]] const std::string& renderer() const { return renderer_; }
  /// Why no graphics card draws, where `automatic` found one, or its driver. Empty if there is none.
  [[nodiscard]] const std::string& passed_over() const { return passed_over_; }
  [[nodiscard]] bool on_processor() const { return on_processor_; }  ///< llvmpipe or softpipe.

  /// Takes GL's functions for this context again, if another one's were loaded meanwhile.
  void load_functions() const;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
  std::string renderer_, passed_over_;
  bool on_processor_ = true;
};

}  // namespace envmap
