#include "envmap/scene/read/obj_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>

#include "envmap/base/error.h"
#include "envmap/scene/mesh.h"
#include "envmap/scene/read/text_lines.h"

namespace envmap {
namespace {

// Names get numbers in the order of their coming.
struct Names {
  std::vector<std::string>& list;
  std::map<std::string, int> numbers = {};

  int operator[](const std::string& name) {
    const auto [found, first] = numbers.try_emplace(name, int(list.size()));
    if (first) list.push_back(name);
    return found->second;
  }
};

struct Reader {
  ObjDocument document = {};
  Names groups{document.groups}, materials{document.materials};
  ObjDocument::Face now = {};  // What the next face belongs to.

  void note_unsupported(const char* what) { note_once(document.unsupported, what); }
};

Direction vector(Words& words) {
  const double x = words.number(), y = words.number(), z = words.number();
  return {x, y, z};
}

Vec2<float> coordinate(Words& words) {
  const float u = words.number(), v = words.number(0);
  return {u, v};
}

// A vertex may have a weight, which only free-form surfaces use, or a colour.
void read_position(Reader& r, Words& words) {
  r.document.positions.push_back(vector(words));
  int more = 0;
  for (; words.more(); ++more) words.number();
  if (more >= 3) r.note_unsupported("colours of vertices");
}

// `index`, from 1, or backwards from the last: what is counted may come later in the file, so it is checked at its end.
int index(std::string_view text, std::size_t there, const Words& words) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const long place = value > 0 ? value - 1L : static_cast<long>(there) + value;
  if (error != std::errc() || end != text.data() + text.size() || value == 0 || place < 0)
    words.fail(quoted(text) + " is no index of a vertex");
  return int(place);
}

// v, v/vt, v//vn or v/vt/vn.
ObjDocument::Corner corner(const ObjDocument& d, std::string_view text, const Words& words) {
  ObjDocument::Corner made;
  const auto next = [&] {
    const std::string_view part = text.substr(0, text.find('/'));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    return part;
  };
  made.position = index(next(), d.positions.size(), words);
  if (const auto part = next(); !part.empty()) made.coordinate = index(part, d.coordinates.size(), words);
  if (const auto part = next(); !part.empty()) made.normal = index(part, d.normals.size(), words);
  if (!text.empty()) words.fail("a corner has more than three indices");
  return made;
}

void read_face(Reader& r, Words& words, int line) {
  ObjDocument& d = r.document;
  ObjDocument::Face face = r.now;
  face.first = d.corners.size();
  while (words.more()) d.corners.push_back(corner(d, words.word(), words));
  if (d.corners.size() > max_corners)
    words.fail(fmt::format("over {} million corners of faces", max_corners / 1000000));
  face.count = int(d.corners.size() - face.first);
  face.line = line;
  if (face.count == 0) words.fail("a face has no corners");
  if (face.count >= 3) return d.faces.push_back(face);
  d.corners.resize(face.first);
  r.note_unsupported("points and lines");
}

int smoothing(Words& words) {
  const std::string_view group = words.word();
  if (group.empty() || group == "off") return 0;
  int number = 0;
  const auto [end, error] = std::from_chars(group.data(), group.data() + group.size(), number);
  if (error != std::errc() || end != group.data() + group.size() || number < 0)
    words.fail(quoted(group) + " is no smoothing group");
  return number;
}

void read_statement(Reader& r, std::string_view key, Words& words, int line) {
  // Of surfaces and curves that are not polygons, and what only other programs obey.
  constexpr std::string_view free_form[] = {"curv", "curv2", "surf"};
  constexpr std::string_view passed_over[] = {"vp",       "cstype",     "deg",      "bmat",  "step",  "parm",
                                              "trim",     "hole",       "scrv",     "sp",    "end",   "con",
                                              "mg",       "bevel",      "lod",      "ctech", "stech", "c_interp",
                                              "d_interp", "shadow_obj", "trace_obj"};
  ObjDocument& d = r.document;
  if (key == "v")
    read_position(r, words);
  else if (key == "vt")
    d.coordinates.push_back(coordinate(words));
  else if (key == "vn")
    d.normals.push_back(vector(words));
  else if (key == "f" || key == "fo")
    read_face(r, words, line);
  else if (key == "g" || key == "o")
    r.now.group = r.groups[words.name()];
  else if (key == "s")
    r.now.smoothing = smoothing(words);
  else if (key == "usemtl")
    r.now.material = r.materials[words.name()];
  else if (key == "mtllib")
    d.libraries.push_back(words.name());
  else if (key == "l" || key == "p")
    r.note_unsupported("points and lines");
  else if (std::ranges::find(free_form, key) != std::end(free_form))
    r.note_unsupported("free-form curves and surfaces");
  else if (key == "usemap" || key == "maplib")
    r.note_unsupported("texture maps without a material");
  else if (std::ranges::find(passed_over, key) == std::end(passed_over))
    words.fail(quoted(key) + " is no statement of OBJ");
}

void check_indices(const ObjDocument& d) {
  for (const ObjDocument::Face& face : d.faces)
    for (std::size_t k = face.first; k < face.first + std::size_t(face.count); ++k) {
      const auto check = [&](int index, std::size_t count, const char* what) {
        if (index >= int(count))
          throw InputError(fmt::format("line {}: names {} {}, but there are {}", face.line, what, index + 1L, count));
      };
      check(d.corners[k].position, d.positions.size(), "vertex");
      check(d.corners[k].coordinate, d.coordinates.size(), "texture coordinate");
      check(d.corners[k].normal, d.normals.size(), "normal");
    }
}

}  // namespace

ObjDocument read_obj_text(std::string_view text) {
  check_text(text);
  Reader r;
  for (TextLines lines(text); lines.next();) {
    Words words(lines);
    if (const std::string_view key = words.word(); !key.empty()) read_statement(r, key, words, lines.number());
    if (std::max({r.document.positions.size(), r.document.normals.size(), r.document.coordinates.size()}) > max_corners)
      words.fail(fmt::format("over {} million vertices", max_corners / 1000000));
  }
  check_indices(r.document);
  return std::move(r.document);
}

}  // namespace envmap
