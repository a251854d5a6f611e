/// @file
/// Words of Python calls as what the library takes, and its errors as Python's.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "envmap/envmap.h"

namespace envmap_python {

using Map = std::shared_ptr<envmap::EnvironmentMap>;  ///< As Python holds one.
using Triple = std::array<double, 3>;

/// An argument that is a Map, or an array to make one of.
struct GivenMap {
  Map map;
};

/// Makes a map of an array. @throws UsageError in one line where it is none.
Map map_of_object(const pybind11::object& array, const std::optional<std::string>& projection,
                  const std::string& forward);

inline Map shared(envmap::EnvironmentMap&& map) { return std::make_shared<envmap::EnvironmentMap>(std::move(map)); }
inline envmap::Rgb<double> rgb(const Triple& t) { return {t[0], t[1], t[2]}; }
inline Triple triple(const envmap::Rgb<double>& c) { return {c.x, c.y, c.z}; }

/// @throws UsageError with the parameter where it is no direction.
inline envmap::Direction direction_of(const std::string& parameter, const Triple& t) {
  const envmap::Direction d(t[0], t[1], t[2]);
  if (envmap::unit(d) == envmap::Direction(0))
    throw envmap::UsageError(parameter + " must be a finite direction other than (0, 0, 0)");
  return d;
}

/// A docstring whose first line inspect.signature() reads.
const char* document(const char* name, const char* parameters, const char* text);

/// @throws UsageError that lists the words.
envmap::Projection projection_of(const std::string& word);
envmap::Forward forward_of(const std::string& word);
envmap::Layout layout_of(const std::string& word);
envmap::Depth depth_of(const std::string& word);
envmap::Filter filter_of(const std::string& word);
envmap::Shape shape_of(const std::string& word);
envmap::Method method_of(const std::string& word);
envmap::Weights weights_of(const std::string& word);

/// The place of a word in a list. @param word_of the word of an element. @throws UsageError that lists them.
template <class List, class WordOf = std::identity>
std::size_t index_of_word(const std::string& what, const std::string& word, const List& list, WordOf word_of = {}) {
  std::string all;
  std::size_t k = 0;
  for (const auto& element : list) {
    const std::string_view w = std::invoke(word_of, element);
    if (w == word) return k;
    all += (k++ == 0 ? "" : ", ") + std::string(w);
  }
  throw envmap::UsageError(what + " '" + word + "' is none of " + all);
}

template <class Enum, class List, class WordOf = std::identity>
Enum named(const std::string& what, const std::string& word, const List& list, WordOf word_of = {}) {
  return static_cast<Enum>(index_of_word(what, word, list, word_of));
}

/// What is given for a parameter. @param kind "a number". @throws UsageError where it is something else.
template <class T>
T cast_to(const pybind11::handle& given, const std::string& parameter, const char* kind) {
  try {
    return pybind11::cast<T>(given);
  } catch (const pybind11::cast_error&) {
    throw envmap::UsageError(parameter + " must be " + kind);
  }
}

/// Error and its four kinds, as classes of the module; what() of the library in one line, and what would help.
void add_errors(pybind11::module_& module);

// Parts of the module, a file each.
void add_map(pybind11::module_& module);
void add_files(pybind11::module_& module);
void add_operations(pybind11::module_& module);
void add_prefilter(pybind11::module_& module);
void add_generate(pybind11::module_& module);
void add_bake(pybind11::module_& module);
void add_scenes(pybind11::module_& module);

/// Calls a Python function with the part done, from any thread. What it raises ends the work and is raised again.
class Reporter {
 public:
  explicit Reporter(pybind11::object function) : function_(std::move(function)) {}

  /// Runs f(run) while other Python threads go on.
  template <class F>
  auto run(F&& f) {
    try {
      const envmap::Run run{.progress = callback()};
      const pybind11::gil_scoped_release others;
      return f(run);
    } catch (const Stopped&) {
      std::rethrow_exception(raised_);
    }
  }

 private:
  struct Stopped {};
  envmap::Progress callback();

  pybind11::object function_;
  std::exception_ptr raised_;
};

}  // namespace envmap_python

namespace pybind11::detail {

/// pybind11's own conversion swallows what is wrong with an array and prints every argument.
template <>
struct type_caster<envmap_python::GivenMap> {
  PYBIND11_TYPE_CASTER(envmap_python::GivenMap, const_name("Map"));

  bool load(handle source, bool) {
    value.map = isinstance<envmap::EnvironmentMap>(source)
                    ? pybind11::cast<envmap_python::Map>(source)
                    : envmap_python::map_of_object(reinterpret_borrow<object>(source), std::nullopt, "+z");
    return true;
  }
};

}  // namespace pybind11::detail
