#include "words.h"

#include <pybind11/eval.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <iterator>
#include <span>

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

constexpr auto word_of = [](auto value) { return name(value); };

// What would help, in the words of these functions.
const char* advice(Remedy remedy) {
  switch (remedy) {
    case Remedy::choose_projection: return ": say which by projection=";
    case Remedy::leave_out_layout:
    case Remedy::leave_out_from_layout: return ": leave out layout=";
    case Remedy::leave_out_face: return ": leave out {face}";
    case Remedy::drop_channels: return ": drop_channels=True leaves them behind";
    case Remedy::repair: return ": read(repair=True) replaces them";
    case Remedy::choose_space: return ": say which by space=";
    case Remedy::choose_faces: return ": say which by faces=";
    case Remedy::choose_format: return ", or say format=";
    case Remedy::choose_plus_z: return ": forward='+z'";
    case Remedy::clamp_or_deepen:
    case Remedy::clamp_or_brighten: return ": depth='float' holds them, or say clamp=True";
    case Remedy::clamp_or_darken: return ": a floating-point format holds them, or say clamp=True";
    case Remedy::clamp_or_dim:
    case Remedy::clamp_or_light_up: return ": say clamp=True";
    case Remedy::force: return ": force=True replaces it";
    case Remedy::make_levels: return ": mipmap() makes levels anew";
    case Remedy::make_cube: return ": convert(to='cube') makes one";
    case Remedy::take_base: return ": headroom=0 reads the picture without its gain map";
    case Remedy::make_all_levels: return ": mipmap() makes them";
    case Remedy::limit_memory:
    case Remedy::allow_pixels:
    case Remedy::choose_linear:
    case Remedy::choose_layer:
    case Remedy::leave_out_shadows:
    case Remedy::find_circle:
    case Remedy::none: break;
  }
  return "";
}

// The number of the system's error that a message ends in, or None.
py::object errno_of(const std::string& message) {
  if (message.find("no such file") != std::string::npos) return py::int_(ENOENT);
  if (message.find("is a folder") != std::string::npos) return py::int_(EISDIR);
  for (const int number :
       {ENOENT, EACCES, EPERM, EISDIR, ENOTDIR, ENOSPC, EROFS, EFBIG, EIO, ENAMETOOLONG, ELOOP, EMFILE, EDQUOT})
    if (message.find(std::strerror(number)) != std::string::npos) return py::int_(number);
  return py::none();
}

void raise(const Error& e, PyObject* kind) {
  std::string line = e.what() + std::string(advice(e.remedy()));
  std::replace(line.begin(), line.end(), '\n', ' ');
  const py::object raised = py::reinterpret_borrow<py::object>(kind)(line);
  raised.attr("code") = std::string(name(e.code()));
  raised.attr("remedy") = std::string(name(e.remedy()));
  const py::object file = e.file().empty() ? py::object(py::none()) : py::str(e.file());
  raised.attr("file") = file;
  const auto* const usage = dynamic_cast<const UsageError*>(&e);
  raised.attr("field") = usage && usage->range() ? py::object(py::str(std::string(usage->range()->field))) : py::none();
  if (e.code() == ErrorCode::input || e.code() == ErrorCode::output) {
    raised.attr("errno") = errno_of(e.what());
    raised.attr("filename") = file;
  }
  PyErr_SetObject(kind, raised.ptr());
}

}  // namespace

const char* document(const char* name, const char* parameters, const char* text) {
  static std::deque<std::string> kept;
  return kept.emplace_back(std::string(name) + "(" + parameters + ")\n--\n\n" + text).c_str();
}

Projection projection_of(const std::string& word) {
  return named<Projection>("projection", word, all_projections, word_of);
}
Forward forward_of(const std::string& word) { return named<Forward>("forward", word, forward_names); }
Layout layout_of(const std::string& word) { return cube_layouts[index_of_word("layout", word, cube_layouts, word_of)]; }
Depth depth_of(const std::string& word) { return named<Depth>("depth", word, depth_names); }
Filter filter_of(const std::string& word) { return named<Filter>("filter", word, filters(), &FilterInfo::name); }
Shape shape_of(const std::string& word) { return named<Shape>("lobe", word, shape_names); }
Method method_of(const std::string& word) {
  return word == former_name_of_treecode ? Method::treecode : named<Method>("method", word, method_names);
}
Weights weights_of(const std::string& word) { return named<Weights>("weights", word, weight_names); }

void add_errors(py::module_& module) {
  using namespace py::literals;
  static PyObject* kinds[enumerators<ErrorCode>];
  static py::exception<Error> error(module, "Error", PyExc_RuntimeError);
  const auto add = [&](ErrorCode code, const char* name, PyObject* builtin) {
    const py::tuple bases = py::make_tuple(error, py::reinterpret_borrow<py::object>(builtin));
    // OSError would write errno and the file's name once more.
    py::dict members("__str__"_a = py::eval("lambda self: self.args[0] if self.args else ''"));
    if (builtin == PyExc_OSError)  // Which keeps these two beside the others, where pickle does not look.
      members["__reduce__"] =
          py::eval("lambda self: (type(self), self.args, dict(vars(self), errno=self.errno, filename=self.filename))");
    PyObject* const kind = PyErr_NewException((std::string("envmap.") + name).c_str(), bases.ptr(), members.ptr());
    module.add_object(name, py::handle(kind));
    kinds[std::size_t(code)] = kind;
  };
  add(ErrorCode::usage, "UsageError", PyExc_ValueError);
  add(ErrorCode::input, "InputError", PyExc_OSError);
  add(ErrorCode::output, "OutputError", PyExc_OSError);
  add(ErrorCode::renderer, "RendererError", PyExc_RuntimeError);
  add(ErrorCode::accuracy, "AccuracyError", PyExc_RuntimeError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& e) {
      raise(e, kinds[std::size_t(e.code())]);
    }
  });
}

Progress Reporter::callback() {
  if (function_.is_none()) return {};
  return [this](double part) {
    const py::gil_scoped_acquire own;
    if (raised_) throw Stopped{};
    try {
      function_(part);
    } catch (const py::error_already_set&) {
      raised_ = std::current_exception();
      throw Stopped{};
    }
  };
}

}  // namespace envmap_python
