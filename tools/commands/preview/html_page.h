// A page to look around in a map with: one file, no network.
#pragma once

#include <string>

#include "envmap/io/images/picture.h"
#include "envmap/io/read.h"

namespace tools {

struct PageOptions {
  std::string file;        // What the page is of, for its title and table.
  std::string space = {};  // What --input-space said.
  double scale = 1;        // Exposure to begin with: a factor.
  envmap::Display display = envmap::Display::reinhard;
  int size = 256;  // Of a face of the cubes in it.
};

// HTML: cubes of the map with its levels, of GGX of roughness 0 to 1 and of the diffuse light, in RGB9E5 and base64.
std::string html_page(const envmap::Source& source, const PageOptions& options);

}  // namespace tools
