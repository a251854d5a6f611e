/// @file
/// Words of Python calls as what the library takes, and its errors as Python's. Types are checked in Python, by
/// envmap/_arguments.py: functions of the compiled module are called with what they take.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "call.h"
#include "envmap/envmap.h"

namespace envmap_python {

using Map = std::shared_ptr<envmap::EnvironmentMap>;  ///< As Python holds one.
using Triple = std::array<double, 3>;

inline Map shared(envmap::EnvironmentMap&& map) { return std::make_shared<envmap::EnvironmentMap>(std::move(map)); }
inline envmap::Rgb<double> rgb(const Triple& t) { return {t[0], t[1], t[2]}; }
inline Triple triple(const envmap::Rgb<double>& c) { return {c.x, c.y, c.z}; }
inline pybind11::tuple tuple(const envmap::Rgb<double>& c) { return pybind11::make_tuple(c.x, c.y, c.z); }
/// Face, row and column, as numpy indexes a map.
inline pybind11::tuple index_of(const envmap::Texel& t) { return pybind11::make_tuple(t.face, t.j, t.i); }

/// @throws UsageError with the parameter where it is no direction.
inline envmap::Direction direction_of(const std::string& parameter, const Triple& t) {
  const envmap::Direction d(t[0], t[1], t[2]);
  if (envmap::unit(d) == envmap::Direction(0))
    throw envmap::UsageError(parameter + " must be a finite direction other than (0, 0, 0)");
  return d;
}

/// @throws UsageError that lists the words.
envmap::Projection projection_of(const std::string& word);
envmap::Forward forward_of(const std::string& word);
envmap::Layout layout_of(const std::string& word);
envmap::Depth depth_of(const std::string& word);
envmap::Filter filter_of(const std::string& word);
envmap::LobeShape shape_of(const std::string& word);
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

/// Errors of the library are raised as those of envmap/_errors.py.
void translate_errors();

/// Calls f(begin, end) for parts of [0, count) from many threads, as many as limit_threads() leaves.
void in_parallel(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& f);

// Parts of the module, a file each.
void add_map(pybind11::module_& module);
void add_files(pybind11::module_& module);
void add_operations(pybind11::module_& module);
void add_light(pybind11::module_& module);
void add_prefilter(pybind11::module_& module);
void add_generate(pybind11::module_& module);
void add_bake(pybind11::module_& module);
void add_scenes(pybind11::module_& module);
void add_words(pybind11::module_& module);  ///< words(): what each of these takes.

}  // namespace envmap_python
