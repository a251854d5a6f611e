// The Python module: the library's public functions on numpy arrays.
#include <pybind11/pybind11.h>
#include <tbb/global_control.h>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

void limit_threads(int count) {
  static std::optional<tbb::global_control> limit;
  check_range(limits::threads, count);
  limit.reset();
  if (count > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(count));
}

}  // namespace

PYBIND11_MODULE(_envmap, m) {
  add_errors(m);
  m.attr("__version__") = ENVMAP_VERSION_TEXT;
  py::options options;
  options.disable_function_signatures();  // document() has those that Python can read.
  add_map(m);
  add_files(m);
  add_operations(m);
  add_prefilter(m);
  add_generate(m);
  add_bake(m);
  add_scenes(m);
  m.def("limit_threads", &limit_threads, "count"_a,
        document("limit_threads", "count", "Lets all calls together use at most so many threads; 0: all cores again."));
}

}  // namespace envmap_python
