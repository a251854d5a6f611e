/// @file
/// Words of Python calls as what the library takes, and its errors as Python's.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "envmap/envmap.h"

namespace envmap_python {

using Map = std::shared_ptr<envmap::EnvironmentMap>;  ///< As Python holds one.
using Triple = std::array<double, 3>;

/// @throws UsageError that lists the words.
envmap::Projection projection_of(const std::string& word);
envmap::Forward forward_of(const std::string& word);
envmap::Layout layout_of(const std::string& word);
envmap::Depth depth_of(const std::string& word);
envmap::Filter filter_of(const std::string& word);
envmap::Shape shape_of(const std::string& word);
envmap::Method method_of(const std::string& word);
envmap::Weights weights_of(const std::string& word);

/// The place of a word among those that there are. @throws UsageError that lists them.
template <class Words>
std::size_t index_of_word(const std::string& what, const std::string& word, const Words& words) {
  std::string all;
  std::size_t k = 0;
  for (const std::string_view w : words) {
    if (w == word) return k;
    all += (k++ == 0 ? "" : ", ") + std::string(w);
  }
  throw envmap::UsageError(what + " '" + word + "' is none of " + all);
}

template <class Enum, class Words>
Enum named(const std::string& what, const std::string& word, const Words& words) {
  return static_cast<Enum>(index_of_word(what, word, words));
}

/// Error and its four kinds, as classes of the module; what() of the library in one line, and what would help.
void add_errors(pybind11::module_& module);

/// envmap.render(): render.cpp.
void add_render(pybind11::module_& module);

/// Calls a Python function with the part done, from any thread. What it raises ends the work and is raised again.
class Reporter {
 public:
  explicit Reporter(pybind11::object function) : function_(std::move(function)) {}

  /// Runs f(progress) while other Python threads go on.
  template <class F>
  auto run(F&& f) {
    try {
      const envmap::Progress progress = callback();
      const pybind11::gil_scoped_release others;
      return f(progress);
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
