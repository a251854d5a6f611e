// Mirrors in a picture, against rays reflected from them into a room with a known answer.
#include "envmap/scenes/render/mirrors.h"

#include <gtest/gtest.h>

#include "drawing.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/shading/shading.h"
#include "rooms.h"

namespace mirrors_test {
namespace {

using namespace envmap;
using drawing::context;

constexpr int size = 96;
constexpr double radius = 0.2;

// The room with mirror balls in it.
SceneGraph hall(const std::vector<Direction>& centres) {
  SceneGraph scene = rooms::room(2);
  scene.materials.push_back({.name = "mirror", .metallic = 1, .roughness = 0});
  scene.meshes.push_back(rooms::ball(48, radius));
  scene.meshes.back().material = int(scene.materials.size()) - 1;
  for (const Direction& c : centres)
    scene.nodes.push_back({.name = "ball " + std::to_string(scene.nodes.size() - 6),
                           .local = glm::translate(Matrix(1), c),
                           .meshes = {int(scene.meshes.size()) - 1}});
  return scene;
}

// From the front wall towards -Z.
Viewpoint camera() { return {.size = size, .at = {0.1, 0.05, 0.95}, .far = 100, .lens = Lens{size, {0.5, 0.5}, 0}}; }
constexpr double pixel = 2 * 0.5 / size;

Viewer viewer(const Viewpoint& from) {
  Viewer v{.at = from.at, .pixel = pixel};
  for (const Direction& inwards : {Direction(1, 0, -0.5), {-1, 0, -0.5}, {0, 1, -0.5}, {0, -1, -0.5}, {0, 0, -1}}) {
    const Direction n = glm::normalize(from.axes * inwards);
    v.planes.emplace_back(n, 1e-3 - glm::dot(n, from.at));
  }
  return v;
}

// A scene with its maps, over frames.
struct Stage {
  Stage(SceneGraph s, Projection to) : scene(std::move(s)) {
    context();
    const std::vector<Mirror> found = find_mirrors(scene, to);
    std::vector<int> nodes;
    for (const Mirror& m : found) nodes.push_back(m.node);
    renderer.emplace(scene, nullptr, nodes);
    mirrors.emplace(scene, found);
  }

  std::vector<Colour> picture(const MirrorOptions& options = {}, const MirrorLook& look = {}) {
    const Viewpoint from = camera();
    FrameState shot{.scene = scene, .pose = pose(scene, 0)};
    shot.look = look;
    updates = mirrors->update(*renderer, shot, {viewer(from)}, options).maps;
    shot.mirrors = mirrors->maps();
    return draw_picture(*renderer, from, shot);
  }

  // Whether all that became of maps is this.
  [[nodiscard]] bool only(MapUpdate::Outcome outcome) const {
    return !updates.empty() && std::ranges::all_of(updates, [&](const MapUpdate& u) { return u.outcome == outcome; });
  }

  SceneGraph scene;
  std::optional<Renderer> renderer;
  std::optional<Mirrors> mirrors;
  std::vector<MapUpdate> updates;  // Of the last picture.
};

float furthest(const std::vector<Colour>& a, const std::vector<Colour>& b) {
  float most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a[k][c] - b[k][c]));
  return most;
}

class EachMirrorMap : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Maps, EachMirrorMap,
                         ::testing::Values(Projection::sphere, Projection::paraboloid, Projection::cube),
                         [](const auto& p) { return identifier(p.param); });

// The mean colour that a pixel shows of the room in a ball; none where it shows the outline, or something else.
std::optional<Direction> shown_by_ball(const Viewpoint& from, int i, int j, const Direction& centre, double margin,
                                       MirrorLookup lookup) {
  constexpr int parts = 4;
  Direction sum(0);
  for (int k = 0; k < parts * parts; ++k) {
    const Direction ray =
        from.lens->ray((i + (k % parts + 0.5) / parts) / size, (j + (k / parts + 0.5) / parts) / size);
    const Direction off = from.at - centre;
    const double b = glm::dot(ray, off), root = b * b - glm::dot(off, off) + radius * radius;
    if (root <= margin) return {};
    const Direction normal = (from.at + (-b - std::sqrt(root)) * ray - centre) / radius,
                    mirrored = glm::reflect(ray, normal);
    const Direction start = lookup == MirrorLookup::direction ? centre : centre + radius * normal;
    sum += 0.5 * (start + rooms::hit(start, mirrored).distance * mirrored + 1.0);
  }
  return sum / double(parts * parts);
}

// @return the largest error on the ball; the others are expected not to be wrong.
double wrong_on_ball(Projection to, MirrorLookup lookup, const Direction& centre) {
  Stage stage(hall({centre}), to);
  const std::vector<Colour> picture = stage.picture({}, {.lookup = lookup});
  const Viewpoint from = camera();
  // A sphere map shows little of what is behind it, which the outline shows.
  const double margin = to == Projection::sphere ? 0.015 : 0.004;
  int on_ball = 0;
  double wrong = 0;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Direction ray = from.lens->ray((i + 0.5) / size, (j + 0.5) / size), off = from.at - centre;
      const double b = glm::dot(ray, off), root = b * b - glm::dot(off, off) + radius * radius;
      const Colour& seen = picture[j * size + i];
      if (root < 0.0) {
        const Direction place = from.at + rooms::hit(from.at, ray).distance * ray;
        EXPECT_TRUE(root >= -0.02 || glm::length(Direction(seen) - (place + 1.0) * 0.5) < 0.02) << i << " " << j;
      } else if (const auto expected = shown_by_ball(from, i, j, centre, margin, lookup)) {
        wrong = std::max(wrong, glm::length(Direction(seen) - *expected));
        ++on_ball;
      }
    }
  EXPECT_GT(on_ball, 80);
  return wrong;
}

// Within a texel of the map on the least of walls.
TEST_P(EachMirrorMap, ABallShowsTheRoomFromItsCentre) {
  EXPECT_LT(wrong_on_ball(GetParam(), MirrorLookup::direction, {0.1, -0.2, -0.3}), 0.06);
}

TEST_P(EachMirrorMap, ABallShowsWhatItsRaysMeet) {
  EXPECT_LT(wrong_on_ball(GetParam(), MirrorLookup::distance, {0.1, -0.2, -0.3}), 0.04);
  EXPECT_LT(wrong_on_ball(GetParam(), MirrorLookup::distance, {-0.5, -0.78, -0.6}), 0.06) << "close to the floor";
}

// A hall without walls, under a sky.
struct Outdoors {
  Outdoors(EnvironmentMap map, Projection p, SceneGraph s = open_hall()) : scene(std::move(s)), to(p) {
    context();
    sky.emplace(std::move(map), 8);
    renderer.emplace(scene, &*sky, nodes_of(find_mirrors(scene, to)));
  }

  static SceneGraph open_hall() {
    SceneGraph scene = hall({ball_at});
    for (Node& node : scene.nodes)
      if (node.name.starts_with("wall")) node.meshes.clear();
    return scene;
  }

  [[nodiscard]] std::vector<Colour> picture(const MirrorLook& look = {}, int samples = 1,
                                            const MirrorOptions& options = {}) {
    Mirrors mirrors(scene, find_mirrors(scene, to));
    FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &*sky, .look = look};
    mirrors.update(*renderer, shot, {viewer(camera())}, options);
    shot.mirrors = mirrors.maps();
    Viewpoint from = camera();
    from.samples = samples;
    return draw_picture(*renderer, from, shot);
  }

  static constexpr Direction ball_at{0.1, -0.2, -0.3};
  SceneGraph scene;
  Projection to;
  std::optional<Environment> sky;
  std::optional<Renderer> renderer;
};

// f(pixel, middle of the ray's way on from the ball, for 16 x 16 rays) of the pixels well inside the ball.
template <class F>
void for_each_pixel_of_ball(F f) {
  const Viewpoint from = camera();
  const Direction off = from.at - Outdoors::ball_at;
  constexpr int parts = 16;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      std::vector<Direction> mirrored;
      for (int k = 0; k < parts * parts; ++k) {
        const Direction ray =
            from.lens->ray((i + (k % parts + 0.5) / parts) / size, (j + (k / parts + 0.5) / parts) / size);
        const double b = glm::dot(ray, off), root = b * b - glm::dot(off, off) + radius * radius;
        if (root < 0.006) break;
        mirrored.push_back(glm::reflect(ray, (off + (-b - std::sqrt(root)) * ray) / radius));
      }
      if (mirrored.size() == parts * parts) f(std::size_t(j * size + i), mirrored);
    }
}

// What is infinitely far is where the ray goes, wherever that starts.
TEST_P(EachMirrorMap, TheSkyIsLookedUpByDirection) {
  Outdoors stage(generate(Directions{}, Projection::cube, 64), GetParam());
  const std::vector<Colour> picture = stage.picture();
  for_each_pixel_of_ball([&](std::size_t k, const std::vector<Direction>& mirrored) {
    Colour sum(0);
    for (const Direction& d : mirrored) sum += stage.sky->lookup(d);
    EXPECT_LT(glm::length(picture[k] - sum / float(mirrored.size())), 0.01);
  });
}

// A sun of one texel of the sky, the only light: each pixel has its mean, with one sample and with many, however coarse
// the map is.
TEST_P(EachMirrorMap, ALoneSunIsAsSharpAsTheSky) {
  for (const auto& [i, j] : {std::pair(75, 24), {100, 31}, {64, 30}}) {
    EnvironmentMap map = generate(Constant{Direction(0)}, Projection::latlong, 64);
    *map.base().texel(0, i, j) = Colour(1000);
    Outdoors stage(std::move(map), GetParam());
    for (const int samples : {1, 4, 16}) {
      const std::vector<Colour> picture = stage.picture({}, samples, {.size = 64});
      double off = 0, square = 0;
      for_each_pixel_of_ball([&](std::size_t k, const std::vector<Direction>& mirrored) {
        double sum = 0;
        for (const Direction& d : mirrored) sum += stage.sky->lookup(d).x;
        const double truth = sum / double(mirrored.size());
        off += std::pow(picture[k].x - truth, 2), square += truth * truth;
      });
      EXPECT_GT(square, 1);
      EXPECT_LT(std::sqrt(off / square), 0.07) << i << ' ' << j << ' ' << samples;
    }
  }
}

// Walls that only shine, with one side open to the sky.
SceneGraph box_before_the_sky(float wall) {
  SceneGraph scene = hall({Outdoors::ball_at});
  for (Material& m : scene.materials)
    if (m.metallic == 0) m.ior = 1, m.emissive = Colour(wall), m.emissive_texture = -1;
  for (Node& node : scene.nodes)
    if (node.name == "wall 0" || node.name == "wall 4") node.meshes.clear();
  return scene;
}

TEST_P(EachMirrorMap, WhiteBeforeWhiteHasNoEdge) {
  for (const int map_size : {0, 48, 512}) {
    Outdoors stage(generate(Constant{Direction(1)}, Projection::cube, 16), GetParam(), box_before_the_sky(1));
    for (const Colour& c : stage.picture({}, 1, {.size = map_size})) EXPECT_NEAR(c.x, 1, 2e-3) << map_size;
  }
}

// As much of the sky as rays see, and nothing darker than the walls or brighter than the sky along its edges.
TEST_P(EachMirrorMap, EdgesBeforeABrightSkyAreInBetween) {
  Outdoors stage(generate(Constant{Direction(100)}, Projection::cube, 16), GetParam(), box_before_the_sky(1));
  const std::vector<Colour> picture = stage.picture();
  const FrameState shot{.scene = stage.scene, .pose = pose(stage.scene, 0), .environment = &*stage.sky};
  Viewpoint from = camera();
  from.samples = 64;
  const std::vector<Colour> truth = raycast_picture(shot, from, {.mirrors = {6}});
  double light = 0, right = 0;
  for_each_pixel_of_ball([&](std::size_t k, const std::vector<Direction>&) {
    EXPECT_GT(picture[k].x, 0.99);
    EXPECT_LT(picture[k].x, 100.2);
    light += picture[k].x, right += truth[k].x;
  });
  EXPECT_NEAR(light / right, 1, 0.02);
}

TEST_P(EachMirrorMap, NoSunShinesIntoAClosedRoom) {
  SceneGraph closed = hall({Outdoors::ball_at});
  for (Material& m : closed.materials)
    if (m.metallic == 0) m.ior = 1;
  Outdoors outside(generate(Constant{Direction(100)}, Projection::cube, 16), GetParam(), closed);
  for (const int map_size : {0, 48, 512})
    for (const Colour& c : outside.picture({}, 4, {.size = map_size})) EXPECT_LT(c.x, 1.01) << map_size;
}

// Half of the sky's light goes through.
TEST_P(EachMirrorMap, BlendedSurfacesBeforeTheSkyAreSeen) {
  SceneGraph scene = Outdoors::open_hall();
  scene.materials.push_back({.base_colour = {0, 0, 0, 0.5F}, .roughness = 1, .ior = 1, .blended = true});
  scene.meshes.push_back(rooms::ball(24, 3));
  scene.meshes.back().material = int(scene.materials.size()) - 1;
  for (std::size_t k = 0; k + 2 < scene.meshes.back().indices.size(); k += 3)
    std::swap(scene.meshes.back().indices[k], scene.meshes.back().indices[k + 1]);
  for (glm::vec3& n : scene.meshes.back().normals) n = -n;
  scene.nodes.push_back({.name = "veil", .meshes = {int(scene.meshes.size()) - 1}});
  Outdoors veiled(generate(Constant{Direction(1)}, Projection::cube, 16), GetParam(), scene),
      open(generate(Constant{Direction(1)}, Projection::cube, 16), GetParam());
  const std::vector<Colour> half = veiled.picture(), whole = open.picture();
  for_each_pixel_of_ball([&](std::size_t k, const std::vector<Direction>&) {
    EXPECT_NEAR(whole[k].x, 1, 2e-3);
    EXPECT_NEAR(half[k].x, 0.5, 0.03);
  });
}

// A sun of one texel of the sky, smaller than those of the map, wherever it stands: of the light of all directions
// the map has as much as the sky. Towards the rim of a sphere map texels are long. By one sample a texel the light was
// up to ten times too low and twice too high.
TEST_P(EachMirrorMap, SmallSunsKeepTheirLight) {
  context();
  SceneGraph scene = hall({{0, 0, 0}});
  for (Node& node : scene.nodes)
    if (node.name.starts_with("wall")) node.meshes.clear();
  for (const auto& [i, j] : {std::pair(80, 121), {194, 126}, {261, 200}, {400, 160}, {503, 41}}) {
    EnvironmentMap map = generate(Directions{}, Projection::latlong, 256);
    *map.base().texel(0, i, j) = Colour(1e6F);
    const Environment sky(std::move(map), 8);
    Renderer renderer(scene, &sky, {6});
    Mirrors mirrors(scene, find_mirrors(scene, GetParam()));
    const FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &sky};
    mirrors.update(renderer, shot, {viewer(camera())}, {.size = 64, .all = true});
    const double light = totals(read_back(*mirrors.maps()[0].texture).base()).flux.x;
    const double off = GetParam() == Projection::sphere ? 0.25 : 0.05;
    EXPECT_NEAR(light / totals(sky.map.base()).flux.x, 1, off) << i << ' ' << j;
  }
}

// Against rays: balls near each other and the walls, a box beside one, which rays pass behind.
TEST_P(EachMirrorMap, DistanceIsNearerToTheTruth) {
  SceneGraph scene = hall({{0.35, -0.2, -0.3}, {-0.3, -0.6, -0.1}});
  scene.materials.push_back({.base_colour = {0, 0, 0, 1}, .roughness = 1, .emissive = Colour(0.9F, 0.1F, 0.1F)});
  scene.meshes.push_back(rooms::ball(16, 0.12));
  scene.meshes.back().material = int(scene.materials.size()) - 1;
  scene.nodes.push_back({.name = "red",
                         .local = glm::translate(Matrix(1), Direction(0.05, -0.35, 0)),
                         .meshes = {int(scene.meshes.size()) - 1}});
  Stage stage(scene, GetParam());
  const std::vector<Colour> truth =
      raycast_picture({.scene = scene, .pose = pose(scene, 0)}, camera(), {.mirrors = {6, 7}});
  const auto rms = [&](MirrorLookup lookup) {
    const std::vector<Colour> picture = stage.picture({}, {.lookup = lookup});
    double sum = 0;
    for (std::size_t k = 0; k < truth.size(); ++k)
      sum += glm::dot(Flux(picture[k] - truth[k]), Flux(picture[k] - truth[k]));
    return std::sqrt(sum / (3 * double(truth.size())));
  };
  const double direction = rms(MirrorLookup::direction), distance = rms(MirrorLookup::distance);
  EXPECT_GT(direction, 0.03);
  EXPECT_LT(distance, 0.52 * direction);
}

TEST_P(EachMirrorMap, LeavingOutChangesNothing) {
  Stage needed(hall({{0.3, -0.2, -0.3}, {-0.4, 0.1, -0.5}, {0, 0, 3}}), GetParam()), all(needed.scene, GetParam());
  for (int frame = 0; frame < 3; ++frame)
    for (const MirrorLookup lookup : {MirrorLookup::distance, MirrorLookup::direction})
      EXPECT_LE(furthest(needed.picture({.bounces = 2}, {.lookup = lookup}),
                         all.picture({.bounces = 2, .all = true}, {.lookup = lookup})),
                1.0F / 255)
          << frame;
}

TEST_P(EachMirrorMap, MirrorsSeeEachOther) {
  const std::vector<Direction> two{{0.3, -0.1, -0.3}, {-0.3, -0.1, -0.3}};
  Stage one(hall({two[0]}), GetParam()), both(hall(two), GetParam());
  const std::vector<Colour> alone = one.picture(), together = both.picture();
  // On the first ball, the second is seen at its left; its own picture there is not black: it mirrors the room in turn.
  float most = 0;
  for (int j = 0; j < size; ++j)
    for (int i = size / 2; i < size; ++i) {
      const auto k = std::size_t(j * size + i);
      most = std::max(most, furthest({alone[k]}, {together[k]}));
      EXPECT_GT(together[k].x + together[k].y + together[k].z, 0.05);
    }
  EXPECT_GT(most, 0.1);
  EXPECT_EQ(furthest(together, both.picture()), 0) << "it had settled";
}

// The map round one of two balls: the other shows the room, and the first, which the map leaves out.
TEST_P(EachMirrorMap, MapsShowMirrorsToo) {
  const std::vector<Direction> two{{0.3, -0.1, -0.3}, {-0.3, -0.1, -0.3}};
  Stage stage(hall(two), Projection::paraboloid);
  const Viewpoint from{.to = GetParam(), .size = size, .at = two[0], .without = 6};
  FrameState shot{.scene = stage.scene, .pose = pose(stage.scene, 0)};
  const auto rms = [](const Drawn& a, const Drawn& b) {
    double sum = 0;
    int count = 0;
    const Level &x = a.radiance.base(), &y = b.radiance.base();
    for (int face = 0; face < x.faces(); ++face)
      for (int j = 0; j < x.height(); ++j)
        for (int i = 0; i < x.width(); ++i, ++count) {
          const Flux off(*x.texel(face, i, j) - *y.texel(face, i, j));
          sum += glm::dot(off, off);
        }
    return std::sqrt(sum / count);
  };
  const Drawn truth = raycast(shot, from, {.mirrors = {6, 7}});
  const Drawn without = draw(*stage.renderer, from, shot, DrawMethod::exact);
  stage.mirrors->update(*stage.renderer, shot, {{.at = from.at, .pixel = 0.5 * pi / size}}, {});
  shot.mirrors = stage.mirrors->maps();
  const double of_maps = rms(draw(*stage.renderer, from, shot, DrawMethod::exact), truth);
  EXPECT_LT(of_maps, 0.02);
  EXPECT_LT(of_maps, 0.2 * rms(without, truth));
}

// By unfolding: from the middle of the room, where rays meet the ball and go on to the walls.
TEST(Mirrors, RaysOfMapsGoOnFromMirrors) {
  const Direction centre(0.3, -0.1, -0.3);
  const SceneGraph scene = hall({centre});
  const Drawn map =
      raycast({.scene = scene, .pose = pose(scene, 0)}, {.to = Projection::cube, .size = 48}, {.mirrors = {6}});
  int on_ball = 0;
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 48; ++i) {
        const Direction ray = glm::normalize(Cube::direction(face, (i + 0.5) / 48, (j + 0.5) / 48));
        const double b = -glm::dot(ray, centre), root = b * b - glm::dot(centre, centre) + radius * radius;
        if (root < 0.002 || b > 0) continue;
        const Direction normal = ((-b - std::sqrt(root)) * ray - centre) / radius, start = centre + radius * normal;
        const Direction mirrored = glm::reflect(ray, normal),
                        place = start + rooms::hit(start, mirrored).distance * mirrored;
        EXPECT_LT(glm::length(Direction(*map.radiance.base().texel(face, i, j)) - 0.5 * (place + 1.0)), 0.02);
        ++on_ball;
      }
  EXPECT_GT(on_ball, 100);
}

TEST_P(EachMirrorMap, TheSamePictureEachTime) {
  Stage a(hall({{0.1, -0.2, -0.3}}), GetParam()), b(a.scene, GetParam());
  EXPECT_EQ(furthest(a.picture(), b.picture()), 0);
}

TEST(Mirrors, WhatStandsStillIsNotDrawnAgain) {
  Stage stage(hall({{0.1, -0.2, -0.3}}), Projection::cube);
  const std::vector<Colour> first = stage.picture();
  EXPECT_TRUE(stage.only(MapUpdate::Outcome::drawn));
  EXPECT_EQ(furthest(first, stage.picture()), 0);
  EXPECT_TRUE(stage.only(MapUpdate::Outcome::unchanged));
}

TEST(Mirrors, ALampBelowAMirrorChangesWhatItShows) {
  SceneGraph scene = hall({{0.1, -0.2, -0.3}});
  scene.nodes.push_back({.parent = 6, .local = glm::translate(Matrix(1), Direction(0.5, 0, 0))});
  scene.lights.push_back({.node = 7});
  Stage stage(scene, Projection::cube);
  stage.picture();
  stage.scene.nodes[7].local = glm::translate(Matrix(1), Direction(-0.5, 0, 0));
  stage.picture();
  EXPECT_TRUE(stage.only(MapUpdate::Outcome::drawn));
}

// A square mirror in the plane z = -0.5 that faces the camera, or the wall behind.
SceneGraph plate(float facing) {
  SceneGraph scene = rooms::room(2);
  scene.materials.push_back({.metallic = 1, .roughness = 0});
  Mesh mesh{.material = 6};
  for (const auto& [x, y] : {std::pair(-0.3F, -0.3F), {0.3F, -0.3F}, {0.3F, 0.3F}, {-0.3F, 0.3F}}) {
    mesh.positions.emplace_back(facing * x, y, -0.5F);
    mesh.normals.emplace_back(0, 0, facing);
    mesh.coordinates.emplace_back(0, 0);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  scene.nodes.push_back({.name = "plate", .meshes = {6}});
  return scene;
}

TEST(Mirrors, AFlatMirrorTakesOneHalfAndNothingFromBehind) {
  Stage front(plate(1), Projection::paraboloid), back(plate(-1), Projection::paraboloid);
  front.picture();
  EXPECT_TRUE(front.only(MapUpdate::Outcome::drawn));
  EXPECT_EQ(front.updates.front().faces, 1);
  back.picture();
  EXPECT_TRUE(back.only(MapUpdate::Outcome::unseen));
}

// The mirror turns round, and so does who looks at it: then nobody needs what it showed.
TEST(Mirrors, FacesThatAreNoLongerNeededShowTheEnvironment) {
  context();
  SceneGraph scene = plate(1);
  Renderer renderer(scene, nullptr, {6});
  Mirrors mirrors(scene, find_mirrors(scene, Projection::cube));
  const auto middle_of_front = [&](const Viewpoint& from) {
    mirrors.update(renderer, {.scene = scene, .pose = pose(scene, 0)}, {viewer(from)}, {.size = 32});
    return *read_back(*mirrors.maps()[0].texture).base().texel(4, 16, 16);
  };
  EXPECT_GT(middle_of_front(camera()).z, 0.9F);
  scene.nodes[6].local = glm::rotate(Matrix(1), pi, Direction(0, 1, 0));
  Viewpoint behind = camera();
  behind.at.z = -behind.at.z, behind.axes = rotation(180, 0, 0);
  EXPECT_EQ(middle_of_front(behind), Colour(0));
}

// In every pixel of the plate, beside its outline, where the flat mirror's rays meet the room.
TEST_P(EachMirrorMap, AFlatMirrorShowsTheMirroredRoom) {
  Stage stage(plate(1), GetParam());
  const std::vector<Colour> picture = stage.picture();
  const Viewpoint from = camera();
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Direction ray = from.lens->ray((i + 0.5) / size, (j + 0.5) / size);
      const Direction place = from.at + (-0.5 - from.at.z) / ray.z * ray, mirrored(ray.x, ray.y, -ray.z);
      if (std::max(std::abs(place.x), std::abs(place.y)) > 0.29) continue;
      const Direction met = place + rooms::hit(place, mirrored).distance * mirrored;
      EXPECT_LT(glm::length(Direction(picture[std::size_t(j * size + i)]) - 0.5 * (met + 1.0)), 0.02);
    }
}

// A second mirror in the plane z = 0.9 that faces the first one. In the map of the first, what it reflects of the walls
// is as far away as their image, and a lamp leaves no glint, which would be smeared over texels.
TEST(Mirrors, AMirrorInAMapIsAsFarAwayAsItsImage) {
  SceneGraph scene = plate(1);
  Mesh second = scene.meshes[6];
  for (glm::vec3& p : second.positions) p = {-3 * p.x, 3 * p.y, 0.9F};
  for (glm::vec3& n : second.normals) n.z = -1;
  scene.meshes.push_back(second);
  scene.nodes.push_back({.name = "second", .meshes = {7}});
  scene.nodes.push_back({.name = "lamp", .local = glm::translate(Matrix(1), Direction(0.1, 0.3, 0.2))});
  scene.lights.push_back({.node = int(scene.nodes.size()) - 1});
  Stage stage(scene, Projection::paraboloid);
  stage.picture({.size = 128, .bounces = 2});
  const MirrorMap& map = stage.mirrors->maps()[0];
  std::vector<float> distances;
  const EnvironmentMap seen = read_back(*map.texture, &distances);
  const Direction from(0, 0, -0.5);
  int images = 0;
  float brightest = 0;
  std::vector<Direction> rays(128);
  for (int j = 0; j < 128; ++j) {
    sample_directions(Projection::paraboloid, 128, 0, j, Vec2<double>(0), rays);
    for (int i = 0; i < 128; ++i) {
      const Direction ray = map.axes * rays[std::size_t(i)], place = from + 1.4 / ray.z * ray;
      const Direction back(ray.x, ray.y, -ray.z), end = place + 1.4 / ray.z * back;
      const bool meets = ray.z > 0 && std::max(std::abs(place.x), std::abs(place.y)) < 0.87;
      if (!meets || std::max(std::abs(end.x), std::abs(end.y)) < 0.5) continue;
      const double image = 1.4 / ray.z + rooms::hit(place, back).distance;
      const float distance = distances[std::size_t(j) * 128 + std::size_t(i)];
      images += std::abs(distance - image) < 0.03 * image;
      images -= std::abs(distance - image) > 0.1 * image;
      brightest = std::max(brightest, seen.base().texel(0, i, j)->x);
    }
  }
  EXPECT_GT(images, 1000);
  EXPECT_LT(brightest, 3);
}

TEST(Mirrors, LooksOfMaps) {
  Stage stage(hall({{0.1, -0.2, -0.3}}), Projection::paraboloid);
  const std::vector<Colour> plain = stage.picture();
  EXPECT_GT(furthest(plain, stage.picture({}, {.tinted = true})), 0.05);
  const std::vector<Colour> by_vertex = stage.picture({}, {.lookup = MirrorLookup::vertex});
  EXPECT_GT(furthest(plain, by_vertex), 0.02);
}

TEST(Mirrors, RoughMetalBlursItsMap) {
  Stage smooth(hall({{0.1, -0.2, -0.3}}), Projection::cube);
  SceneGraph scene = smooth.scene;
  scene.materials.back().roughness = 1;
  context();
  const Mirror rough = make_mirror(scene, 6, Projection::paraboloid);
  EXPECT_TRUE(rough.rough);
  EXPECT_EQ(rough.to, Projection::cube);
  Renderer renderer(scene, nullptr, {6});
  Mirrors mirrors(scene, {rough});
  FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  mirrors.update(renderer, shot, {viewer(camera())}, {.size = 32});
  shot.mirrors = mirrors.maps();
  const std::vector<Colour> picture = draw_picture(renderer, camera(), shot);
  // Along a row through the ball colours spread less than on the smooth one: the room's mean is (0.5, 0.5, 0.5).
  const auto spread = [](const std::vector<Colour>& p) {
    float low = 1, high = 0;
    for (int i = 42; i < 54; ++i) {
      low = std::min(low, p[54 * size + i].x);
      high = std::max(high, p[54 * size + i].x);
    }
    return high - low;
  };
  EXPECT_LT(spread(picture), 0.8F * spread(smooth.picture()));
  EXPECT_GT(picture[54 * size + 48].x, 0.1F);
}

}  // namespace
}  // namespace mirrors_test
