// The compiled half of the Python module: the library's public functions, thin. What people call is envmap/*.py.
#include <pybind11/pybind11.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include "words.h"

namespace envmap_python {
namespace {

using namespace envmap;

void limit_threads(int count) {
  static std::optional<tbb::global_control> limit;
  check_range(limits::threads, count);
  limit.reset();
  if (count > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(count));
}

}  // namespace

void in_parallel(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const auto& r) { f(r.begin(), r.end()); });
}

PYBIND11_MODULE(_envmap, m) {
  translate_errors();
  m.attr("__version__") = ENVMAP_VERSION_TEXT;
  add_before_fork(m);
  add_words(m);
  add_map(m);
  add_files(m);
  add_operations(m);
  add_light(m);
  add_prefilter(m);
  add_generate(m);
  add_bake(m);
  add_scenes(m);
  m.def("limit_threads", &limit_threads);
}

}  // namespace envmap_python
