#include "basin.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/scenes/render/draw.h"

namespace water {
namespace {

using namespace envmap;

// Where column (x, y) of the field stands.
Direction place(const Basin& b, const HeightField& field, double x, double y) {
  return {(2 * x / (field.columns() - 1) - 1) * b.wide, field.at(x, y), (2 * y / (field.rows() - 1) - 1) * b.deep};
}

Direction normal_at(const Basin& b, const HeightField& field, double x, double y) {
  const double dx = (field.at(x + 1, y) - field.at(x - 1, y)) * (field.columns() - 1) / (4 * b.wide);
  const double dz = (field.at(x, y + 1) - field.at(x, y - 1)) * (field.rows() - 1) / (4 * b.deep);
  return glm::normalize(Direction(-dx, 1, -dz));
}

// Beer's law on the light's way down, as if it were upright. On the way up the water itself absorbs (add_water()).
glm::vec4 under_water(const Basin& b, double y) {
  return {glm::exp(float(std::min(y, 0.0)) * b.tint), 1};
}

// A parallelogram from its upper left corner, cut into columns and rows; texture coordinates in metres.
Mesh wall(int material, const Direction& corner, const Direction& right, const Direction& down, int columns = 1, int rows = 1) {
  Mesh mesh{.material = material};
  const Direction normal = glm::normalize(glm::cross(down, right));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double u = double(i) / columns, v = double(j) / rows;
      mesh.positions.emplace_back(corner + u * right + v * down);
      mesh.normals.emplace_back(normal);
      mesh.coordinates.emplace_back(u * glm::length(right), v * glm::length(down));
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto a = std::uint32_t(j * (columns + 1) + i), b = a + std::uint32_t(columns) + 1;
      for (const std::uint32_t k : {a, b, b + 1, a, b + 1, a + 1}) mesh.indices.push_back(k);
    }
  return mesh;
}

void append(Mesh& mesh, const Mesh& more) {
  const auto first = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
  mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
  mesh.coordinates.insert(mesh.coordinates.end(), more.coordinates.begin(), more.coordinates.end());
  for (const std::uint32_t k : more.indices) mesh.indices.push_back(first + k);
}

// Seen from outside.
Mesh box(int material, const Direction& low, const Direction& high) {
  const Direction s = high - low, x(s.x, 0, 0), y(0, -s.y, 0), z(0, 0, s.z), corner(low.x, high.y, low.z);
  Mesh mesh = wall(material, corner + z, x, y);
  append(mesh, wall(material, corner + x, -x, y));
  append(mesh, wall(material, corner, z, y));
  append(mesh, wall(material, corner + x + z, -z, y));
  append(mesh, wall(material, corner, x, z));
  return mesh;
}

Mesh ball(int material, const Direction& centre, double radius) {
  constexpr int rows = 24;
  Mesh mesh = wall(material, {0, 0, 0}, {2, 0, 0}, {0, -1, 0}, 2 * rows, rows);
  for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
    const double a = pi * mesh.positions[k].x, b = -pi * mesh.positions[k].y;
    const Direction n(std::sin(b) * std::sin(a), std::cos(b), std::sin(b) * std::cos(a));
    mesh.positions[k] = centre + radius * n;
    mesh.normals[k] = n;
  }
  return mesh;
}

// Four by four tiles with joints, each of a shade of its own.
Texture tiles(const Colour& tile, const Colour& joint, float spread) {
  constexpr int side = 32, count = 4;
  Texture texture{.width = side * count, .height = side * count};
  for (int j = 0; j < texture.height; ++j)
    for (int i = 0; i < texture.width; ++i) {
      const bool between = i % side < 2 || j % side < 2;
      const int kind = (i / side * 7 + j / side * 13 + i / side * (j / side)) % 5;
      const Colour c = between ? joint : tile * (1 - spread * float(kind) / 4);
      texture.texels.emplace_back(glm::u8vec4(255.0F * glm::pow(c, Colour(1 / 2.2F)) + 0.5F, 255));
    }
  return texture;
}

struct Builder {
  Pool pool;

  int material(const char* name, const Colour& colour, float roughness, int texture = -1) {
    pool.scene.materials.push_back(
        {.name = name, .base_colour = glm::vec4(colour, 1), .base_colour_texture = texture, .roughness = roughness});
    return int(pool.scene.materials.size()) - 1;
  }

  // @return the mesh's number.
  int add(const char* name, Mesh mesh) {
    const int number = int(pool.scene.meshes.size());
    pool.scene.meshes.push_back(std::move(mesh));
    pool.scene.nodes.push_back({.name = name, .meshes = {number}});
    return number;
  }

  int texture(Texture image) {
    pool.scene.textures.push_back(std::move(image));
    return int(pool.scene.textures.size()) - 1;
  }
};

// A wall of the basin from the rim to the floor, darker the deeper.
Mesh inner_wall(const Basin& b, int material, const Direction& corner, const Direction& right) {
  constexpr int rows = 24;
  Mesh mesh = wall(material, corner, right, {0, b.floor - b.rim, 0}, 1, rows);
  for (const glm::vec3& p : mesh.positions) mesh.colours.push_back(under_water(b, p.y));
  for (glm::vec2& at : mesh.coordinates) at /= 0.4F;  // Tiles of 10 cm.
  return mesh;
}

void add_basin(Builder& to, const Basin& b, const HeightField& field) {
  const double x = b.wide, z = b.deep, top = b.rim;
  const int blue = to.material("tiles", Colour(1), 0.6F, to.texture(tiles({0.07F, 0.3F, 0.42F}, {0.55F, 0.58F, 0.56F}, 0.35F)));
  Mesh walls = inner_wall(b, blue, {-x, top, -z}, {2 * x, 0, 0});
  for (const auto& [corner, right] : {std::pair(Direction(x, top, z), Direction(-2 * x, 0, 0)),
                                      {Direction(x, top, -z), Direction(0, 0, 2 * z)},
                                      {Direction(-x, top, z), Direction(0, 0, -2 * z)}}) {
    const Mesh more = inner_wall(b, blue, corner, right);
    append(walls, more);
    walls.colours.insert(walls.colours.end(), more.colours.begin(), more.colours.end());
  }
  to.add("walls", std::move(walls));
  Mesh floor = wall(blue, {-x, b.floor, -z}, {2 * x, 0, 0}, {0, 0, 2 * z}, field.columns() - 1, field.rows() - 1);
  for (glm::vec2& at : floor.coordinates) at /= 0.4F;
  floor.colours.assign(floor.positions.size(), under_water(b, b.floor));
  to.pool.floor = to.add("floor", std::move(floor));
}

// Four slabs round a hole, from |x| <= wide, |z| <= deep outwards.
Mesh frame(int material, double height, double wide, double deep, double border, double unit) {
  const double x = wide + border, z = deep + border;
  Mesh mesh = wall(material, {-x, height, -z}, {2 * x, 0, 0}, {0, 0, border});
  append(mesh, wall(material, {-x, height, deep}, {2 * x, 0, 0}, {0, 0, border}));
  append(mesh, wall(material, {-x, height, -deep}, {border, 0, 0}, {0, 0, 2 * deep}));
  append(mesh, wall(material, {wide, height, -deep}, {border, 0, 0}, {0, 0, 2 * deep}));
  for (glm::vec2& at : mesh.coordinates) at /= unit;
  return mesh;
}

// What else is reflected: paving, a row of pillars under a beam, and two balls.
void add_surroundings(Builder& to, const Basin& b) {
  const int paving =
      to.material("paving", Colour(1), 0.8F, to.texture(tiles({0.62F, 0.55F, 0.45F}, {0.4F, 0.36F, 0.3F}, 0.2F)));
  const int white = to.material("white", {0.8F, 0.78F, 0.74F}, 0.9F);
  const int red = to.material("red", {0.7F, 0.06F, 0.03F}, 0.8F), yellow = to.material("yellow", {0.85F, 0.5F, 0.05F}, 0.8F);
  to.add("paving", frame(paving, b.rim, b.wide, b.deep, 1.4, 1.6));
  const double z = -b.deep - 0.55;
  Mesh pergola = box(white, {-1.9, b.rim + 1.15, z - 0.13}, {1.9, b.rim + 1.35, z + 0.13});
  for (const double x : {-1.7, -0.85, 0.0, 0.85, 1.7}) append(pergola, box(white, {x - 0.1, b.rim, z - 0.1}, {x + 0.1, b.rim + 1.15, z + 0.1}));
  to.add("pergola", std::move(pergola));
  to.add("red ball", ball(red, {-0.75, b.rim + 0.2, -b.deep - 0.25}, 0.2));
  to.add("yellow ball", ball(yellow, {1.2, b.rim + 0.14, -b.deep - 0.2}, 0.14));
}

// The water is its surface alone: what it absorbs along ends where something is met.
void add_water(Builder& to, const Basin& b, const HeightField& field) {
  constexpr float endless = 1e6F;
  to.pool.scene.materials.push_back({.name = "water",
                                     .roughness = 0,
                                     .transmission = 1,
                                     .ior = float(1 / b.eta),
                                     .solid = true,
                                     .absorption = b.tint,
                                     .thickness = endless});
  const int material = int(to.pool.scene.materials.size()) - 1;
  to.pool.water = to.add("water", wall(material, {-b.wide, 0, -b.deep}, {2 * b.wide, 0, 0}, {0, 0, 2 * b.deep},
                                       field.columns() - 1, field.rows() - 1));
  to.pool.water_node = int(to.pool.scene.nodes.size()) - 1;
}

}  // namespace

Pool make_pool(const Basin& basin, const HeightField& field) {
  Builder builder;
  add_basin(builder, basin, field);
  add_surroundings(builder, basin);
  add_water(builder, basin, field);
  return std::move(builder.pool);
}

void add_model(Pool& pool, const Basin& basin, const SceneGraph& model, double height) {
  const Pose placed = pose(model, 0);
  Direction low(std::numeric_limits<double>::infinity()), high = -low;
  for (const Instance& i : instances(model))
    for (const glm::vec3& p : model.meshes[std::size_t(i.mesh)].positions) {
      const Direction there(placed[std::size_t(i.node)] * glm::vec<4, double, glm::highp>(p, 1));
      low = glm::min(low, there), high = glm::max(high, there);
    }
  if (!(high.y > low.y)) throw UsageError("the model has no height: --model takes a scene with meshes");
  const Direction foot(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
  const Matrix stand = glm::translate(Matrix(1), Direction(0, basin.floor, 0)) *
                       glm::scale(Matrix(1), Direction(height / (high.y - low.y))) * glm::translate(Matrix(1), -foot);
  SceneGraph& scene = pool.scene;
  const int first_mesh = int(scene.meshes.size()), first_material = int(scene.materials.size()),
            first_texture = int(scene.textures.size());
  scene.textures.insert(scene.textures.end(), model.textures.begin(), model.textures.end());
  for (Material m : model.materials) {
    for (int* texture : {&m.base_colour_texture, &m.metallic_roughness_texture, &m.emissive_texture, &m.normal_texture,
                         &m.occlusion_texture, &m.coat_texture, &m.coat_roughness_texture, &m.coat_normal_texture,
                         &m.sheen_texture, &m.sheen_roughness_texture})
      if (*texture >= 0) *texture += first_texture;
    scene.materials.push_back(std::move(m));
  }
  for (Mesh mesh : model.meshes) {
    mesh.material += first_material;
    scene.meshes.push_back(std::move(mesh));
  }
  for (const Instance& i : instances(model))
    scene.nodes.push_back({.name = "model", .local = stand * placed[std::size_t(i.node)], .meshes = {first_mesh + i.mesh}});
}

void set_waves(Pool& pool, const Basin& basin, const HeightField& field, const Direction& sun) {
  Mesh& water = pool.scene.meshes[std::size_t(pool.water)];
  Mesh& floor = pool.scene.meshes[std::size_t(pool.floor)];
  const std::vector<float> light = caustics(basin, field, sun);
  const auto sunlight = float(basin.sunlight);
  std::size_t k = 0;
  for (int j = 0; j < field.rows(); ++j)
    for (int i = 0; i < field.columns(); ++i, ++k) {
      water.positions[k] = place(basin, field, i, j);
      water.normals[k] = normal_at(basin, field, i, j);
      floor.colours[k] = under_water(basin, basin.floor) * glm::vec4(Colour(1 - sunlight + sunlight * light[k]), 1);
    }
}

std::vector<float> caustics(const Basin& basin, const HeightField& field, const Direction& sun) {
  const int columns = field.columns(), rows = field.rows();
  std::vector<float> light(std::size_t(columns) * std::size_t(rows), 0.0F);
  const auto splat = [&](double x, double y, double amount) {
    const int i = int(std::floor(x)), j = int(std::floor(y));
    for (int b = 0; b < 2; ++b)
      for (int a = 0; a < 2; ++a) {
        // What goes beyond the floor is mirrored back: walls of light tiles.
        const auto back = [](int k, int size) {
          return std::clamp(k < 0 ? -1 - k : k >= size ? 2 * size - 1 - k : k, 0, size - 1);
        };
        const double weight = (a ? x - i : 1 - x + i) * (b ? y - j : 1 - y + j);
        light[std::size_t(back(j + b, rows)) * std::size_t(columns) +
              std::size_t(back(i + a, columns))] += float(amount * weight);
      }
  };
  constexpr int fine = 3;  // Rays along each side of a column.
  for (int j = 0; j < rows * fine; ++j)
    for (int i = 0; i < columns * fine; ++i) {
      const double x = (i + 0.5) / fine - 0.5, y = (j + 0.5) / fine - 0.5;
      const Direction n = normal_at(basin, field, x, y), d = glm::refract(-sun, n, basin.eta);
      const double t = (basin.floor - field.at(x, y)) / d.y;
      splat(x + t * d.x / basin.wide * 0.5 * (columns - 1), y + t * d.z / basin.deep * 0.5 * (rows - 1), 1.0 / (fine * fine));
    }
  return light;
}

}  // namespace water
