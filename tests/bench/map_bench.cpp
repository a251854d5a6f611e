// What the map of a scene costs: by triangles, projection, method and size, as comma-separated values on stdout.
//
//   map_bench [auto|osmesa|egl [MOST_TRIANGLES [LARGEST_SIZE [ROUNDS]]]] > run.csv
//
// The context, the scene on the card and the programs are made once and timed by themselves (lines that begin with #).
// Of each way of drawing there is a map for warming up, then as many as fit into a twentieth of a second, in ROUNDS
// rounds over all ways, of which the fastest counts.
//
// On OSMesa and llvmpipe seconds are those of the processor, all threads; on a card those of the clock.
//
//   draw    seconds until glFinish returns; the map stays where it was drawn. raycast: without the tree of boxes
//   whole   seconds until radiance, distances and surfaces are in memory. raycast: with the tree
//   wrong   texels that show another surface than raycast's, or one whose distance is off by more than 1%, in %
//   auto    1 where --method auto takes this method for one of many frames
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string>

#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/rays/embree_scene.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"

namespace {

using namespace envmap;

// `around` by `across` quads round the axis Z, radius 1, 2 * around * across triangles.
Mesh torus(int around, int across) {
  Mesh mesh{.material = 1};
  for (int j = 0; j <= across; ++j)
    for (int i = 0; i <= around; ++i) {
      const double u = 2 * pi * i / around, v = 2 * pi * j / across;
      const Direction out(std::cos(u), std::sin(u), 0), n = std::cos(v) * out + Direction(0, 0, std::sin(v));
      mesh.positions.emplace_back(out + 0.4 * n);
      mesh.normals.emplace_back(n);
      mesh.coordinates.emplace_back(0, 0);
    }
  const auto at = [&](int i, int j) { return std::uint32_t(j * (around + 1) + i); };
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < around; ++i)
      for (const std::uint32_t k : {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        mesh.indices.push_back(k);
  return mesh;
}

// The box [-1,1]^3, seen from inside: 12 triangles.
Mesh box() {
  Mesh mesh{.material = 0};
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Direction out(0), along(0);
      out[axis] = side;
      along[(axis + 1) % 3] = 1;
      const Direction up = glm::cross(along, out);  // along x up = -out: counter-clockwise from inside.
      const auto first = std::uint32_t(mesh.positions.size());
      for (const Direction& corner : {-along - up, along - up, along + up, up - along}) {
        mesh.positions.emplace_back(out + corner);
        mesh.normals.emplace_back(-out);
        mesh.coordinates.emplace_back(0, 0);
      }
      for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + k);
    }
  return mesh;
}

// A room of 12 triangles, and in it up to 24 tori, evenly round the middle on a spiral: about so many triangles in all.
SceneGraph hall(int wanted) {
  SceneGraph scene;
  scene.materials = {{.base_colour = {0.8, 0.7, 0.6, 1}}, {.base_colour = {0.3, 0.5, 0.8, 1}}};
  const int tori = std::clamp((wanted - 12) / 40, 4, 24);
  const double quads = 0.5 * (wanted - 12) / tori;
  const int across = std::max(3, int(std::sqrt(quads / 2)));
  scene.meshes = {box(), torus(std::max(3, int(std::lround(quads / across))), across)};
  scene.nodes.push_back({.name = "room", .meshes = {0}});
  for (int k = 0; k < tori; ++k) {
    const double z = 1 - (2 * k + 1.0) / tori, turn = 2.399963229728653 * k, radius = std::sqrt(1 - z * z);
    Matrix local = glm::translate(Matrix(1), 0.6 * Direction(radius * std::cos(turn), radius * std::sin(turn), z));
    local = glm::rotate(local, turn, glm::normalize(Direction(1, 2, 3)));
    scene.nodes.push_back({.name = fmt::format("torus {}", k),
                           .local = glm::scale(local, Direction(k % 2 == 0 ? 0.12 : 0.08)),
                           .meshes = {1}});
  }
  return scene;
}

// What draws on the processor is timed by the seconds that all threads took of it, which other work on the machine
// changes little; what a card draws by the clock.
bool by_processor_time = false;

double now() {
  if (by_processor_time) return double(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds(auto&& work) {
  const double start = now();
  work();
  return now() - start;
}

// The mean of as many as fit into a twentieth of a second, after one that does not count if it is short.
double seconds_each(auto&& work) {
  const double first = seconds(work);
  if (first > 0.2) return first;
  const int count = std::clamp(int(0.05 / std::max(first, 1e-6)), 1, 200);
  return seconds([&] {
           for (int k = 0; k < count; ++k) work();
         }) /
         count;
}

struct Case {
  DrawMethod method;
  Viewpoint from;
  double draw = std::numeric_limits<double>::infinity(), whole = draw, wrong = 0;
};

// In %.
double difference(const Drawn& map, const Drawn& truth) {
  std::size_t wrong = 0, texels = 0;
  for (std::size_t k = 0; k < truth.surfaces.size(); ++k) {
    if (truth.surfaces[k] == 0) continue;  // Round discs.
    ++texels;
    const bool near = std::abs(map.distances[k] - truth.distances[k]) <= 0.01 * truth.distances[k];
    wrong += near && map.surfaces[k] == truth.surfaces[k] ? 0 : 1;
  }
  return 100.0 * double(wrong) / double(texels);
}

std::vector<Case> cases(int largest) {
  std::vector<Case> all;
  for (int size = 64; size <= largest; size *= 2)
    for (const Projection to :
         {Projection::cube, Projection::sphere, Projection::paraboloid, Projection::latlong, Projection::octahedral})
      for (const DrawMethod method : {DrawMethod::raycast, DrawMethod::exact, DrawMethod::distort,
                                      DrawMethod::tessellate, DrawMethod::resample}) {
        // A cube's straight sides need no tessellation, and its resampling is six passes as well.
        const bool twice =
            to == Projection::cube && (method == DrawMethod::tessellate || method == DrawMethod::resample);
        if (can_draw(method, to) && !twice)
          all.push_back({method, {.to = to, .size = size, .at = {0.05, -0.1, 0.07}, .axes = rotation(20, 30, 40)}});
      }
  return all;
}

void measure(Case& c, Renderer& renderer, const FrameState& shot, double tree) {
  if (c.method == DrawMethod::raycast) {
    c.whole = std::min(c.whole, seconds_each([&] { raycast(shot, c.from); }));
    c.draw = std::max(0.0, c.whole - tree);
    return;
  }
  c.whole = std::min(c.whole, seconds_each([&] { draw(renderer, c.from, shot, c.method); }));
  Viewpoint from = c.from;
  if (c.method == DrawMethod::resample) from.to = Projection::cube;
  const DrawMethod method = c.method == DrawMethod::resample ? DrawMethod::distort : c.method;
  MapTexture map(from.to, from.size);
  c.draw = std::min(c.draw, seconds_each([&] {
                      renderer.draw(from, shot, method, map);
                      glFinish();
                    }));
}

void run(const SceneGraph& scene, int largest, int rounds) {
  const FrameState shot{.scene = scene, .pose = pose(scene, 0), .ambient = Colour(1)};
  std::optional<Renderer> renderer;
  const double upload = seconds([&] { renderer.emplace(scene, nullptr), glFinish(); });
  std::vector<Case> all = cases(largest);
  std::optional<Drawn> truth;
  double programs = 0;
  for (Case& c : all) {
    if (c.method == DrawMethod::raycast) {
      truth = raycast(shot, c.from);
      continue;
    }
    Drawn map;
    const double first = seconds([&] { map = draw(*renderer, c.from, shot, c.method); });
    if (c.from.size == 64) programs += first;
    c.wrong = difference(map, *truth);
  }
  double tree = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    tree = std::min(tree, seconds_each([&] { EmbreeScene(shot, all[0].from.at, -1); }));
    for (Case& c : all) measure(c, *renderer, shot, tree);
  }
  const std::size_t count = triangles(scene);
  fmt::print("# {} triangles: upload {:.4f} s, tree {:.5f} s, first maps of 64 by all methods {:.3f} s\n", count,
             upload, tree, programs);
  for (const Case& c : all)
    fmt::print("{},{},{},{},{:.6f},{:.6f},{:.4f},{}\n", count, name(c.from.to),
               draw_method_names[std::size_t(c.method)], c.from.size, c.draw, c.whole, c.wrong,
               int(c.method == cheapest(c.from.to, c.from.size, {.triangles = count}, true, !by_processor_time)));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  const std::string word = argc > 1 ? argv[1] : "auto";
  const auto kind = ContextKind(std::ranges::find(context_names, word) - context_names);
  std::optional<Context> context;
  const double opening = seconds([&] { context.emplace(kind); });
  by_processor_time = context->on_processor();
  fmt::print("# {}\n# opened in {:.3f} s\n# seconds of {}\ntriangles,projection,method,size,draw,whole,wrong,auto\n",
             context->renderer(), opening, by_processor_time ? "processor time, all threads" : "the clock");
  for (int wanted = 100; wanted <= number(2, 1'000'000); wanted *= 10) run(hall(wanted), number(3, 1024), number(4, 3));
}
