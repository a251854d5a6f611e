#include "envmap/scenes/read/draco.h"

#include <draco/compression/decode.h>

#include <array>
#include <cmath>
#include <new>

#include "envmap/base/error.h"
#include "envmap/scenes/scene/mesh.h"

namespace envmap {
namespace {

template <class V>
std::vector<V> values(const draco::Mesh& mesh, unsigned id) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr || attribute->num_components() != V::length())
    throw InputError("lacks an attribute in its Draco mesh");
  std::vector<V> found(mesh.num_points());
  for (std::uint32_t k = 0; k < mesh.num_points(); ++k) {
    std::array<float, V::length()> value{};
    const draco::AttributeValueIndex at = attribute->mapped_index(draco::PointIndex(k));
    if (at.value() >= attribute->size() || !attribute->ConvertValue<float, V::length()>(at, value.data()))
      throw InputError("holds a damaged Draco mesh");
    for (int c = 0; c < V::length(); ++c) {
      if (!std::isfinite(value[c])) throw InputError("holds NaN or infinite numbers");
      found[k][c] = value[c];
    }
  }
  return found;
}

}  // namespace

Mesh decode_draco(std::span<const std::byte> bytes, const DracoAttributes& attributes) try {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw InputError("holds a damaged Draco mesh");
  const draco::Mesh& from = *decoded.value();
  if (std::size_t{3} * from.num_faces() + from.num_points() > max_corners) throw InputError("holds too many corners");
  Mesh mesh;
  mesh.positions = values<glm::vec3>(from, attributes.position);
  if (attributes.normal) mesh.normals = values<glm::vec3>(from, *attributes.normal);
  if (attributes.coordinate) mesh.coordinates = values<glm::vec2>(from, *attributes.coordinate);
  for (std::uint32_t f = 0; f < from.num_faces(); ++f)
    for (const draco::PointIndex& corner : from.face(draco::FaceIndex(f))) {
      if (corner.value() >= from.num_points()) throw InputError("holds a damaged Draco mesh");
      mesh.indices.push_back(corner.value());
    }
  return mesh;
} catch (const std::bad_alloc&) {
  throw InputError("holds a Draco mesh that memory cannot");
}

}  // namespace envmap
