#include "words.h"

#include <pybind11/stl.h>

#include <map>
#include <vector>

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

constexpr auto word_of = [](auto value) { return name(value); };

// The file system's names need not be UTF-8.
py::object decoded(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
}

void raise(const Error& e) {
  const auto* const usage = dynamic_cast<const UsageError*>(&e);
  const py::object none = py::none();
  const py::object field = usage && usage->range() ? py::str(std::string(usage->range()->field)) : none;
  const py::object error =
      py::module_::import("envmap._errors")
          .attr("error_of")(std::string(name(e.code())), decoded(e.what()), std::string(name(e.remedy())),
                            e.file().empty() ? none : decoded(e.file()), field);
  PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
}

template <class List, class WordOf = std::identity>
std::vector<std::string> words_of(const List& list, WordOf word = {}) {
  std::vector<std::string> all;
  for (const auto& element : list) all.emplace_back(std::invoke(word, element));
  return all;
}

std::map<std::string, std::vector<std::string>> words() {
  return {{"Projection", words_of(all_projections, word_of)},
          {"Forward", words_of(forward_names)},
          {"Layout", words_of(cube_layouts, word_of)},
          {"Depth", words_of(depth_names)},
          {"Filter", words_of(filters(), &FilterInfo::name)},
          {"Lobe", words_of(parametric_lobe_names)},
          {"Method", words_of(method_names)},
          {"PixelFormat", words_of(pixel_format_names)},
          {"Lens", words_of(camera_model_names)},
          {"ToneCurve", words_of(display_names)},
          {"Mirror", words_of(mirrored_axis_names)},
          {"Weights", words_of(weight_names)},
          {"Quality", words_of(qualities, &Quality::name)}};
}

}  // namespace

Projection projection_of(const std::string& word) {
  return named<Projection>("projection", word, all_projections, word_of);
}
Forward forward_of(const std::string& word) { return named<Forward>("forward", word, forward_names); }
Layout layout_of(const std::string& word) { return cube_layouts[index_of_word("layout", word, cube_layouts, word_of)]; }
Depth depth_of(const std::string& word) { return named<Depth>("depth", word, depth_names); }
Filter filter_of(const std::string& word) { return named<Filter>("filter", word, filters(), &FilterInfo::name); }
LobeShape shape_of(const std::string& word) { return named<LobeShape>("lobe", word, parametric_lobe_names); }
Method method_of(const std::string& word) {
  return word == former_name_of_treecode ? Method::treecode : named<Method>("method", word, method_names);
}
Weights weights_of(const std::string& word) { return named<Weights>("weights", word, weight_names); }

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& e) {
      raise(e);
    }
  });
}

void add_words(py::module_& module) { module.def("words", &words); }

}  // namespace envmap_python
