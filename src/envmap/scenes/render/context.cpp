#include "envmap/scenes/render/context.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <glad/gl.h>
// After glad, which stands in for GL's own header.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/scenes/render/osmesa.h"

namespace envmap {

// What makes a context current, and undoes it.
struct Context::Handle {
  virtual ~Handle() = default;
  [[nodiscard]] virtual GLADloadfunc loader() const = 0;
};

namespace {

// A library that stays open: drivers do not survive being unloaded and loaded again.
class Library {
 public:
  explicit Library(const char* name) : handle_(dlopen(name, RTLD_NOW | RTLD_LOCAL)) {
    if (handle_ == nullptr) throw RendererError(dlerror());
  }

  template <class F>
  F* function(const char* name) const {
    void* found = dlsym(handle_, name);
    if (found == nullptr) throw RendererError(dlerror());
    return reinterpret_cast<F*>(found);
  }

 private:
  void* handle_;
};

struct OsMesa {
  Library library{"libOSMesa.so.8"};
  osmesa::Create* create = library.function<osmesa::Create>("OSMesaCreateContextAttribs");
  osmesa::MakeCurrent* make_current = library.function<osmesa::MakeCurrent>("OSMesaMakeCurrent");
  osmesa::Destroy* destroy = library.function<osmesa::Destroy>("OSMesaDestroyContext");
  GLADloadfunc load = library.function<GLADapiproc(const char*)>("OSMesaGetProcAddress");
};

template <class Base>
struct OsMesaContext : Base {
  OsMesa mesa;
  osmesa::Context context;
  std::array<GLubyte, 4> pixel{};  // All drawing goes to framebuffer objects, but there must be one.

  OsMesaContext() {
    constexpr std::array<int, 11> wanted{osmesa::format,
                                         osmesa::rgba,
                                         osmesa::depth_bits,
                                         0,
                                         osmesa::profile,
                                         osmesa::core_profile,
                                         osmesa::major_version,
                                         4,
                                         osmesa::minor_version,
                                         5,
                                         0};
    context = mesa.create(wanted.data(), nullptr);
    if (context == nullptr) throw RendererError("OSMesa gives no OpenGL 4.5 core context");
    if (mesa.make_current(context, pixel.data(), GL_UNSIGNED_BYTE, 1, 1) != GL_TRUE) {
      mesa.destroy(context);
      throw RendererError("OSMesa cannot make its context current");
    }
  }
  ~OsMesaContext() override { mesa.destroy(context); }
  [[nodiscard]] GLADloadfunc loader() const override { return mesa.load; }
};

struct Egl {
  Library library{"libEGL.so.1"};
  PFNEGLGETPROCADDRESSPROC load =
      library.function<std::remove_pointer_t<PFNEGLGETPROCADDRESSPROC>>("eglGetProcAddress");

  template <class F>
  F function(const char* name) const {
    const auto found = reinterpret_cast<F>(load(name));
    if (found == nullptr) throw RendererError(fmt::format("EGL lacks {}", name));
    return found;
  }

  PFNEGLGETPLATFORMDISPLAYPROC display = function<PFNEGLGETPLATFORMDISPLAYPROC>("eglGetPlatformDisplay");
  PFNEGLINITIALIZEPROC initialize = function<PFNEGLINITIALIZEPROC>("eglInitialize");
  PFNEGLTERMINATEPROC terminate = function<PFNEGLTERMINATEPROC>("eglTerminate");
  PFNEGLBINDAPIPROC bind_api = function<PFNEGLBINDAPIPROC>("eglBindAPI");
  PFNEGLCREATECONTEXTPROC create = function<PFNEGLCREATECONTEXTPROC>("eglCreateContext");
  PFNEGLDESTROYCONTEXTPROC destroy = function<PFNEGLDESTROYCONTEXTPROC>("eglDestroyContext");
  PFNEGLMAKECURRENTPROC make_current = function<PFNEGLMAKECURRENTPROC>("eglMakeCurrent");
  PFNEGLQUERYSTRINGPROC query = function<PFNEGLQUERYSTRINGPROC>("eglQueryString");

  struct Devices {
    std::vector<EGLDeviceEXT> cards, others;  // Others: what Mesa draws with on the processor.
  };
  // None where EGL cannot list them.
  [[nodiscard]] Devices devices() const {
    const auto list = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(load("eglQueryDevicesEXT"));
    const auto ask = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(load("eglQueryDeviceStringEXT"));
    std::array<EGLDeviceEXT, 32> all{};
    EGLint count = 0;
    if (list == nullptr || ask == nullptr || list(all.size(), all.data(), &count) != EGL_TRUE) return {};
    Devices found;
    for (EGLint k = 0; k < count; ++k) {
      const EGLDeviceEXT device = all[k];
      const char* extensions = ask(device, EGL_EXTENSIONS);
      const bool software = extensions != nullptr && std::strstr(extensions, "EGL_MESA_device_software") != nullptr;
      (software ? found.others : found.cards).push_back(device);
    }
    return found;
  }
};

// How many contexts are open on a display, which is the process's: the last one closes it.
int& contexts_on(EGLDisplay display) {
  static std::map<EGLDisplay, int> counts;
  return counts[display];
}

template <class Base>
struct EglContext : Base {
  Egl egl;
  EGLDisplay display;
  EGLContext context = EGL_NO_CONTEXT;

  EglContext(const Egl& library, EGLenum platform, void* device)
      : egl(library), display(egl.display(platform, device, nullptr)) {
    if (display == EGL_NO_DISPLAY || egl.initialize(display, nullptr, nullptr) != EGL_TRUE)
      throw RendererError("EGL opens no display of this kind");
    ++contexts_on(display);
    constexpr std::array<EGLint, 7> wanted{
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    if (egl.bind_api(EGL_OPENGL_API) == EGL_TRUE)
      context = egl.create(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted.data());
    if (context != EGL_NO_CONTEXT && egl.make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE)
      return;
    close();
    throw RendererError("EGL gives no OpenGL 4.5 core context");
  }
  ~EglContext() override { close(); }
  [[nodiscard]] GLADloadfunc loader() const override { return egl.load; }

 private:
  void close() {
    egl.make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) egl.destroy(display, context);
    if (--contexts_on(display) == 0) egl.terminate(display);
  }
};

// The first context that can be had: card by card, then surfaceless, then on the processor. Surfaceless, Mesa chooses a
// device, and Mesa does not know the cards of other drivers.
template <class Base>
std::unique_ptr<Base> open_egl(bool cards_only) {
  const Egl egl;
  const auto [cards, others] = egl.devices();
  if (cards_only && cards.empty()) throw RendererError("EGL finds no graphics card");
  std::string reason = "EGL finds no device";
  std::unique_ptr<Base> context;
  const auto opens = [&](EGLenum platform, void* device) {
    try {
      context = std::make_unique<EglContext<Base>>(egl, platform, device);
    } catch (const RendererError& e) {
      reason = e.what();
    }
    return context != nullptr;
  };
  const auto opens_device = [&](EGLDeviceEXT device) { return opens(EGL_PLATFORM_DEVICE_EXT, device); };
  const char* known = egl.query(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const bool surfaceless = known != nullptr && std::strstr(known, "EGL_MESA_platform_surfaceless") != nullptr;
  if (std::ranges::any_of(cards, opens_device) ||
      (surfaceless && opens(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY)) ||
      (!cards_only && std::ranges::any_of(others, opens_device)))
    return context;
  throw RendererError(reason);
}

bool draws_on_processor(const std::string& renderer) {
  return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
}

// What to do where there is no context. Packages have other names on each family of systems: os-release(5).
std::string remedy(ContextKind kind) {
  if (kind == ContextKind::osmesa) return "install libosmesa6, or draw through EGL: Mesa 25.1 removed OSMesa";
  std::ifstream file("/etc/os-release");
  const std::string system(std::istreambuf_iterator<char>(file), {});
  const auto is = [&](const char* word) { return system.find(word) != std::string::npos; };
  if (kind == ContextKind::automatic && is("VERSION_CODENAME=bookworm")) return "install libosmesa6";
  if (is("debian")) return "install libegl1 and libgl1-mesa-dri";
  if (is("fedora") || is("rhel")) return "install mesa-libEGL and mesa-dri-drivers";
  return "install Mesa with EGL and llvmpipe";
}

// Whether there is a card to draw with, or a driver that was installed for one. @param reason why none of them drew.
bool is_worth_telling(const std::string& reason) {
  std::error_code error;
  if (reason.find("EGL finds no graphics card") == reason.npos)
    return reason.find("libEGL.so.1: cannot open shared object file") == reason.npos;
  return std::filesystem::exists("/dev/dri/renderD128", error) || std::filesystem::exists("/dev/nvidiactl", error);
}

std::string text_of(GLenum name) { return reinterpret_cast<const char*>(glGetString(name)); }

}  // namespace

namespace {

// Whose functions GL's are.
GLADloadfunc loaded_by = nullptr;

bool load(GLADloadfunc loader) {
  loaded_by = loader;
  return gladLoadGL(loader) != 0;
}

}  // namespace

void Context::load_functions() const {
  if (handle_->loader() != loaded_by) load(handle_->loader());
}

Context::Context(ContextKind kind) {
  std::string reasons;
  const auto opens = [&](const char* through, auto open) {
    handle_.reset();
    try {
      handle_ = open();
      if (!load(handle_->loader())) throw RendererError("no functions of OpenGL");
    } catch (const RendererError& e) {
      reasons += fmt::format("{} ({})", reasons.empty() ? through : fmt::format(" or {}", through), e.what());
      return false;
    }
    const std::string name = text_of(GL_RENDERER);
    on_processor_ = draws_on_processor(name);
    renderer_ = fmt::format("{}, {}, OpenGL {}", through, name, text_of(GL_VERSION));
    return true;
  };
  if (kind == ContextKind::automatic) {
    if (opens("EGL", [] { return open_egl<Handle>(true); }) && !on_processor_) return;
    if (!reasons.empty() && is_worth_telling(reasons)) passed_over_ = reasons;
    reasons.clear();
  }
  if (kind != ContextKind::egl && opens("OSMesa", [] { return std::make_unique<OsMesaContext<Handle>>(); })) return;
  if (kind != ContextKind::osmesa && opens("EGL", [] { return open_egl<Handle>(false); })) return;
  throw RendererError(fmt::format("no context through {}: {}", reasons, remedy(kind)));
}

bool finds_graphics_card() {
  try {
    return !Egl().devices().cards.empty() && !Context(ContextKind::egl).on_processor();
  } catch (const RendererError&) {
    return false;
  }
}

Context::~Context() = default;

}  // namespace envmap
