// Decodes Draco meshes with libdraco, bounded by what the accessors declare.
#include "gltf/draco_mesh.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <stdexcept>

#include "gltf/component.h"

namespace nmc::gltf {
namespace {

std::span<const std::uint8_t> packed_view(const Document& document, const Json& extension, const Where& where) {
  return stored_view(document,
                     get_index(extension, "bufferView", list_size(document.json, "bufferViews", document.name), where));
}

draco::DecoderBuffer to_buffer(std::span<const std::uint8_t> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return buffer;
}

/// Vertices and faces that the stream claims. Draco allocates by these before it looks at the data, so they must be
/// known first.
struct Claim {
  std::uint32_t points = 0;
  std::uint32_t faces = 0;
};

bool read_claim(std::span<const std::uint8_t> bytes, Claim& claim) {
  draco::DecoderBuffer buffer = to_buffer(bytes);
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return false;
  const auto version = static_cast<std::uint16_t>(DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor));
  // KHR_draco_mesh_compression is about triangle meshes of bitstream 2.2.
  if (header.encoder_type != draco::TRIANGULAR_MESH || version < DRACO_BITSTREAM_VERSION(2, 2)) return false;
  buffer.set_bitstream_version(version);
  if ((header.flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return false;
  }
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
    return draco::DecodeVarint(&claim.faces, &buffer) && draco::DecodeVarint(&claim.points, &buffer);
  }
  std::uint8_t traversal = 0;
  return buffer.Decode(&traversal) && draco::DecodeVarint(&claim.points, &buffer) &&
         draco::DecodeVarint(&claim.faces, &buffer);
}

std::unique_ptr<draco::Mesh> decode(std::span<const std::uint8_t> bytes, std::uint64_t vertices, const Where& where) {
  Claim claim;
  if (!read_claim(bytes, claim)) where.fail("has Draco data with a broken header");
  // The best real meshes take about a bit per face; the factor leaves room for degenerate ones.
  const std::uint64_t limit = std::max<std::uint64_t>(std::uint64_t{1} << 20, 256 * std::uint64_t{bytes.size()});
  if (claim.points > limit || claim.faces > limit || vertices > limit)
    where.fail("claims more vertices than its Draco data can hold");
  try {
    draco::DecoderBuffer buffer = to_buffer(bytes);
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok())
      where.fail(fmt::format("has Draco data that does not decode ({})", result.status().error_msg_string()));
    std::unique_ptr<draco::Mesh> mesh = std::move(result).value();
    if (mesh->num_points() != vertices) {
      where.fail(
          fmt::format("has {} vertices in its Draco data, but its accessors have {}", mesh->num_points(), vertices));
    }
    return mesh;
  } catch (const std::bad_alloc&) {
    where.fail("has Draco data that needs more memory than there is");
  } catch (const std::length_error&) {
    where.fail("has Draco data that needs more memory than there is");
  }
}

std::vector<float> read_attribute(draco::Mesh& mesh, std::uint32_t id, int width, const Where& where) {
  const std::int32_t index = mesh.GetAttributeIdByUniqueId(id);
  if (index < 0) where.fail(fmt::format("refers to the Draco attribute {}, which does not exist", id));
  draco::PointAttribute* attribute = mesh.attribute(index);
  // The accessor says whether integers are normalized, whatever the stream says.
  attribute->set_normalized(false);
  if (attribute->num_components() != width) {
    where.fail(fmt::format("has {} numbers per vertex in the Draco attribute {} where its accessor has {}",
                           attribute->num_components(), id, width));
  }
  std::vector<float> values;
  values.reserve(mesh.num_points() * static_cast<std::size_t>(width));
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    std::array<float, 16> element{};
    const draco::AttributeValueIndex value = attribute->mapped_index(point);
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue(value, static_cast<std::int8_t>(width), element.data())) {
      where.fail(fmt::format("has a broken Draco attribute {}", id));
    }
    values.insert(values.end(), element.begin(), element.begin() + width);
  }
  return values;
}

}  // namespace

std::vector<DracoAttribute> unpack_draco(const Document& document, const Json& primitive,
                                         bool (*wanted)(const std::string& semantic), const Where& where) {
  std::vector<DracoAttribute> attributes;
  const Json& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
  std::unique_ptr<draco::Mesh> mesh;
  for (const auto& [semantic, id] : extension["attributes"].items()) {
    if (!wanted(semantic)) continue;
    const std::size_t index =
        as_index(primitive["attributes"][semantic], document.json["accessors"].size(), where, semantic);
    const Json& accessor = document.json["accessors"][index];
    const int width = component_count(accessor["type"].get_ref<const std::string&>());
    if (!mesh) mesh = decode(packed_view(document, extension, where), accessor["count"].get<std::uint64_t>(), where);
    attributes.push_back({semantic, width, read_attribute(*mesh, id.get<std::uint32_t>(), width, where)});
  }
  return attributes;
}

}  // namespace nmc::gltf
