#include "gltf/draco_write.h"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "base/error.h"
#include "gltf/append.h"
#include "gltf/compact.h"
#include "gltf/component.h"
#include "gltf/edit_tools.h"
#include "gltf/json_text.h"
#include "gltf/json_tools.h"
#include "gltf/meshopt.h"
#include "gltf/references.h"

namespace nmc::gltf {
namespace {

constexpr const char* draco_name = "KHR_draco_mesh_compression";
constexpr int most_bits = 24;
constexpr int triangles = 4;

/// JSON that the extension's object needs.
constexpr std::size_t extension_json_bytes = 150;

/// The elements of an accessor, one after the other.
struct Elements {
  Bytes bytes;
  std::size_t count = 0;
  int width = 0;
  int component_type = float_32;
  bool normalized = false;
};

/// Nothing for what is not packed: sparse accessors, and those without data.
std::optional<Elements> read_elements(const Document& document, std::size_t index) {
  const Json& accessor = document.json["accessors"][index];
  if (find(accessor, "sparse") != nullptr || find(accessor, "bufferView") == nullptr) return std::nullopt;
  const auto& type = accessor["type"].get_ref<const std::string&>();
  Elements elements;
  elements.count = accessor["count"].get<std::size_t>();
  elements.width = component_count(type);
  elements.component_type = accessor["componentType"].get<int>();
  elements.normalized = accessor.value("normalized", false);
  const std::size_t view_index = accessor["bufferView"].get<std::size_t>();
  const Json& view = document.json["bufferViews"][view_index];
  const std::optional<Bytes> unpacked = unpack_meshopt(document, view_index);
  const std::span<const std::uint8_t> bytes =
      unpacked ? std::span<const std::uint8_t>(*unpacked) : stored_view(document, view_index);
  const auto size = static_cast<std::size_t>(element_bytes(type, static_cast<std::uint64_t>(elements.component_type)));
  const std::size_t stride = view.value("byteStride", size);
  const std::size_t offset = accessor.value("byteOffset", std::size_t{0});
  elements.bytes.reserve(elements.count * size);
  for (std::size_t i = 0; i < elements.count; ++i) {
    const auto element = bytes.subspan(offset + i * stride, size);
    elements.bytes.insert(elements.bytes.end(), element.begin(), element.end());
  }
  return elements;
}

std::vector<std::uint32_t> read_indices(const Elements& elements) {
  std::vector<std::uint32_t> indices(elements.count);
  const auto bytes = static_cast<std::size_t>(component_bytes(static_cast<std::uint64_t>(elements.component_type)));
  for (std::size_t i = 0; i < elements.count; ++i)
    std::memcpy(&indices[i], elements.bytes.data() + i * bytes, bytes);  // both are little-endian
  return indices;
}

draco::DataType draco_type(int component_type) {
  switch (component_type) {
    case signed_byte:
      return draco::DT_INT8;
    case unsigned_byte:
      return draco::DT_UINT8;
    case signed_short:
      return draco::DT_INT16;
    case unsigned_short:
      return draco::DT_UINT16;
    case unsigned_int:
      return draco::DT_UINT32;
    default:
      return draco::DT_FLOAT32;
  }
}

draco::GeometryAttribute::Type draco_kind(const std::string& semantic) {
  if (semantic == "POSITION") return draco::GeometryAttribute::POSITION;
  if (semantic == "NORMAL") return draco::GeometryAttribute::NORMAL;
  if (semantic.starts_with("TEXCOORD_")) return draco::GeometryAttribute::TEX_COORD;
  if (semantic.starts_with("COLOR_")) return draco::GeometryAttribute::COLOR;
  return draco::GeometryAttribute::GENERIC;
}

int bits_of(const std::string& semantic, const DracoBits& bits) {
  if (semantic == "POSITION") return bits.position;
  if (semantic == "NORMAL") return bits.normal;
  if (semantic.starts_with("TEXCOORD_")) return bits.texcoord;
  if (semantic.starts_with("COLOR_")) return bits.color;
  return semantic.starts_with("WEIGHTS_") ? bits.weight : bits.generic;
}

struct Attribute {
  std::string semantic;
  std::size_t accessor = 0;
  Elements elements;
  int id = 0;  ///< in the Draco mesh
};

/// A primitive that can be packed.
struct Primitive {
  std::size_t mesh = 0;
  std::size_t index = 0;
  std::vector<Attribute> attributes;
  std::optional<std::size_t> index_accessor;
  std::size_t index_bytes = 0;
  std::vector<std::uint32_t> indices;
  std::size_t vertices = 0;
};

std::unique_ptr<draco::Mesh> to_draco(Primitive& primitive) {
  auto mesh = std::make_unique<draco::Mesh>();
  mesh->set_num_points(static_cast<std::uint32_t>(primitive.vertices));
  for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    const std::uint32_t* corner = primitive.indices.data() + i;
    mesh->AddFace({{draco::PointIndex(corner[0]), draco::PointIndex(corner[1]), draco::PointIndex(corner[2])}});
  }
  for (Attribute& attribute : primitive.attributes) {
    const Elements& elements = attribute.elements;
    const auto bytes = static_cast<std::int64_t>(elements.bytes.size() / elements.count);
    draco::GeometryAttribute description;
    description.Init(draco_kind(attribute.semantic), nullptr, static_cast<std::uint8_t>(elements.width),
                     draco_type(elements.component_type), elements.normalized, bytes, 0);
    attribute.id = mesh->AddAttribute(description, true, static_cast<std::uint32_t>(elements.count));
    for (std::uint32_t i = 0; i < elements.count; ++i) {
      mesh->attribute(attribute.id)
          ->SetAttributeValue(draco::AttributeValueIndex(i),
                              elements.bytes.data() + i * static_cast<std::size_t>(bytes));
    }
  }
  return mesh;
}

Bytes encode(const Primitive& primitive, const draco::Mesh& mesh, const DracoBits& bits, int method) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  encoder.SetSpeedOptions(3, 3);
  for (const Attribute& attribute : primitive.attributes) {
    if (attribute.elements.component_type != float_32) continue;
    encoder.SetAttributeQuantization(attribute.id, bits_of(attribute.semantic, bits));
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeToBuffer(&buffer).ok()) return {};
  const auto* data = reinterpret_cast<const std::uint8_t*>(buffer.data());
  return {data, data + buffer.size()};
}

std::unique_ptr<draco::Mesh> decode(const Bytes& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto result = decoder.DecodeMeshFromBuffer(&buffer);
  return result.ok() ? std::move(result).value() : nullptr;
}

/// The floats of an attribute in the order of the mesh's points.
std::vector<float> values_of(const draco::Mesh& mesh, const Attribute& attribute) {
  const draco::PointAttribute* decoded = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(attribute.id));
  std::vector<float> values;
  std::array<float, 16> element{};
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    decoded->ConvertValue(decoded->mapped_index(point), static_cast<std::int8_t>(attribute.elements.width),
                          element.data());
    values.insert(values.end(), element.begin(), element.begin() + attribute.elements.width);
  }
  return values;
}

std::vector<float> floats_of(const Elements& elements) {
  std::vector<float> values(elements.count * static_cast<std::size_t>(elements.width));
  std::memcpy(values.data(), elements.bytes.data(), elements.bytes.size());
  return values;
}

double largest_distance(std::span<const float> a, std::span<const float> b) {
  double largest = 0;
  for (std::size_t i = 0; i + 2 < a.size(); i += 3)
    largest = std::max(largest, std::hypot(static_cast<double>(a[i]) - static_cast<double>(b[i]),
                                           static_cast<double>(a[i + 1]) - static_cast<double>(b[i + 1]),
                                           static_cast<double>(a[i + 2]) - static_cast<double>(b[i + 2])));
  return largest;
}

/// Weights of four per vertex as viewers use them: of sum 1.
std::array<double, 4> of_sum_one(const float* weights) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += static_cast<double>(weights[k]);
  std::array<double, 4> scaled{};
  for (std::size_t k = 0; k < 4 && sum > 0; ++k) scaled[k] = static_cast<double>(weights[k]) / sum;
  return scaled;
}

double largest_weight_change(std::span<const float> a, std::span<const float> b) {
  double largest = 0;
  for (std::size_t i = 0; i + 3 < a.size(); i += 4) {
    const std::array<double, 4> before = of_sum_one(a.data() + i), after = of_sum_one(b.data() + i);
    double change = 0;
    for (std::size_t k = 0; k < 4; ++k) change += std::abs(after[k] - before[k]);
    largest = std::max(largest, change);
  }
  return largest;
}

/// What the rounding of the bits does. The sequential method keeps the order of the vertices and rounds like every
/// other.
std::optional<DracoError> measure(const Primitive& primitive, const draco::Mesh& mesh, const DracoBits& bits) {
  const std::unique_ptr<draco::Mesh> decoded = decode(encode(primitive, mesh, bits, draco::MESH_SEQUENTIAL_ENCODING));
  if (decoded == nullptr || decoded->num_points() != primitive.vertices) return std::nullopt;
  DracoError error;
  for (const Attribute& attribute : primitive.attributes) {
    if (attribute.elements.component_type != float_32) continue;
    if (attribute.semantic == "POSITION") {
      error.position = largest_distance(floats_of(attribute.elements), values_of(*decoded, attribute));
    } else if (attribute.semantic.starts_with("WEIGHTS_")) {
      error.weight += largest_weight_change(floats_of(attribute.elements), values_of(*decoded, attribute));
    }
  }
  return error;
}

struct Packed {
  Bytes bytes;
  std::size_t vertices = 0;
  std::size_t indices = 0;
  std::array<float, 3> low{}, high{};  ///< of the decoded positions
};

/// The smaller of Draco's two methods at these bits, decoded to see what is in it.
std::optional<Packed> pack(const Primitive& primitive, const draco::Mesh& mesh, const DracoBits& bits) {
  Packed packed;
  packed.bytes = encode(primitive, mesh, bits, draco::MESH_EDGEBREAKER_ENCODING);
  if (Bytes other = encode(primitive, mesh, bits, draco::MESH_SEQUENTIAL_ENCODING);
      packed.bytes.empty() || (!other.empty() && other.size() < packed.bytes.size()))
    packed.bytes = std::move(other);
  const std::unique_ptr<draco::Mesh> decoded = packed.bytes.empty() ? nullptr : decode(packed.bytes);
  if (decoded == nullptr || 3 * std::size_t{decoded->num_faces()} != primitive.indices.size()) return std::nullopt;
  packed.vertices = decoded->num_points();
  packed.indices = 3 * std::size_t{decoded->num_faces()};
  for (const Attribute& attribute : primitive.attributes) {
    if (attribute.semantic != "POSITION") continue;
    const std::vector<float> positions = values_of(*decoded, attribute);
    packed.low = {positions[0], positions[1], positions[2]};
    packed.high = packed.low;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      packed.low[i % 3] = std::min(packed.low[i % 3], positions[i]);
      packed.high[i % 3] = std::max(packed.high[i % 3], positions[i]);
    }
  }
  return packed;
}

/// Why a primitive stays as it is; empty when it can be packed.
std::string reason_to_leave(const Json& primitive) {
  if (const Json* extensions = find(primitive, "extensions"); extensions != nullptr && !extensions->empty())
    return "have extensions";
  if (find(primitive, "targets") != nullptr) return "have morph targets";
  if (primitive.value("mode", triangles) != triangles) return "are not made of triangles";
  if (!primitive["attributes"].contains("POSITION")) return "have no positions";
  return {};
}

std::string read_primitive(const Document& document, Primitive& primitive) {
  const Json& json = document.json["meshes"][primitive.mesh]["primitives"][primitive.index];
  if (std::string reason = reason_to_leave(json); !reason.empty()) return reason;
  for (const auto& [semantic, accessor] : json["attributes"].items()) {
    Attribute attribute{semantic, accessor.get<std::size_t>(), {}, 0};
    std::optional<Elements> elements = read_elements(document, attribute.accessor);
    if (!elements) return "have sparse attributes";
    attribute.elements = std::move(*elements);
    primitive.attributes.push_back(std::move(attribute));
  }
  primitive.vertices = primitive.attributes.front().elements.count;
  for (const Attribute& attribute : primitive.attributes) {
    if (attribute.elements.count != primitive.vertices) return "have attributes of different counts";
  }
  if (const Json* indices = find(json, "indices")) {
    primitive.index_accessor = indices->get<std::size_t>();
    const std::optional<Elements> elements = read_elements(document, *primitive.index_accessor);
    if (!elements) return "have sparse indices";
    primitive.indices = read_indices(*elements);
    primitive.index_bytes = elements->bytes.size();
  } else {
    for (std::uint32_t i = 0; i < primitive.vertices; ++i) primitive.indices.push_back(i);
  }
  if (primitive.indices.empty() || primitive.indices.size() % 3 != 0) return "have no whole triangles";
  const auto outside = [&](std::uint32_t index) { return index >= primitive.vertices; };
  if (std::any_of(primitive.indices.begin(), primitive.indices.end(), outside)) return "have indices without vertices";
  return {};
}

/// The bytes of a primitive's accessors; those that several use are split evenly among them.
std::size_t own_bytes(const Primitive& primitive, const std::map<std::size_t, std::size_t>& uses) {
  std::size_t bytes = 0;
  for (const Attribute& attribute : primitive.attributes)
    bytes += attribute.elements.bytes.size() / uses.at(attribute.accessor);
  if (primitive.index_accessor) bytes += primitive.index_bytes / uses.at(*primitive.index_accessor);
  return bytes;
}

std::map<std::size_t, std::size_t> accessor_uses(Document& document) {
  std::map<std::size_t, std::size_t> uses;
  for (const Reference& reference : find_references(document)) {
    if (reference.kind == ObjectKind::accessor) ++uses[reference.value->get<std::size_t>()];
  }
  return uses;
}

std::size_t add_accessor(Document& document, Json accessor) {
  Json& accessors = array_member(document.json, "accessors");
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

Json numbers(const std::array<float, 3>& values) {
  return Json::array({shortest_number(values[0]), shortest_number(values[1]), shortest_number(values[2])});
}

/// Puts the packed primitive in the place of the old one, whose accessors become candidates for removal.
void replace(Document& document, const Primitive& primitive, const Packed& packed, Candidates& candidates) {
  const std::size_t view = append_view(document, packed.bytes);
  Json ids = Json::object();
  Json attributes = Json::object();
  for (const Attribute& attribute : primitive.attributes) {
    Json accessor = document.json["accessors"][attribute.accessor];
    candidates.accessors.insert(attribute.accessor);
    for (const char* key : {"bufferView", "byteOffset"}) accessor.erase(key);
    accessor["count"] = packed.vertices;
    if (attribute.semantic == "POSITION") {
      accessor["min"] = numbers(packed.low);
      accessor["max"] = numbers(packed.high);
    } else {
      for (const char* key : {"min", "max"}) accessor.erase(key);
    }
    attributes[attribute.semantic] = add_accessor(document, std::move(accessor));
    ids[attribute.semantic] = attribute.id;
  }
  Json indices{{"componentType", packed.vertices > 65535 ? unsigned_int : unsigned_short},
               {"count", packed.indices},
               {"type", "SCALAR"}};
  const std::size_t index_accessor = add_accessor(document, std::move(indices));
  if (primitive.index_accessor) candidates.accessors.insert(*primitive.index_accessor);
  Json& json = document.json["meshes"][primitive.mesh]["primitives"][primitive.index];
  json["attributes"] = std::move(attributes);
  json["indices"] = index_accessor;
  object_member(json, "extensions")[draco_name] = {{"bufferView", view}, {"attributes", std::move(ids)}};
}

/// Bits at which the error can be borne; nothing where there are none.
std::optional<DracoBits> fitting_bits(const Primitive& primitive, const draco::Mesh& mesh, DracoBits bits,
                                      const std::function<bool(std::size_t, const DracoError&)>& fits) {
  for (;;) {
    const std::optional<DracoError> error = measure(primitive, mesh, bits);
    if (!error) return std::nullopt;
    if (fits(primitive.mesh, *error)) return bits;
    if (bits.position >= most_bits && bits.weight >= most_bits) return std::nullopt;
    const bool position_alone_fits = fits(primitive.mesh, {error->position, 0});
    if (!position_alone_fits) bits.position = std::min(most_bits, bits.position + 1);
    if (position_alone_fits || bits.position == most_bits) bits.weight = std::min(most_bits, bits.weight + 1);
  }
}

}  // namespace

DracoResult pack_meshes(Document& document, const DracoBits& bits,
                        const std::function<bool(std::size_t mesh, const DracoError& error)>& fits) {
  DracoResult result;
  const std::map<std::size_t, std::size_t> uses = accessor_uses(document);
  Candidates candidates;
  for (std::size_t m = 0; m < array_size(document.json, "meshes"); ++m) {
    for (std::size_t p = 0; p < document.json["meshes"][m]["primitives"].size(); ++p) {
      Primitive primitive;
      primitive.mesh = m;
      primitive.index = p;
      const auto leave = [&](const std::string& reason) { ++result.left[reason]; };
      if (const std::string reason = read_primitive(document, primitive); !reason.empty()) {
        leave(reason);
        continue;
      }
      const std::unique_ptr<draco::Mesh> mesh = to_draco(primitive);
      const std::optional<DracoBits> chosen = fitting_bits(primitive, *mesh, bits, fits);
      if (!chosen) {
        leave("cannot be rounded within the tolerance");
        continue;
      }
      const std::optional<Packed> packed = pack(primitive, *mesh, *chosen);
      const std::size_t before = own_bytes(primitive, uses);
      if (!packed || packed->bytes.size() + extension_json_bytes >= before) {
        leave("would not become smaller");
        continue;
      }
      replace(document, primitive, *packed, candidates);
      ++result.packed;
      result.bytes_before += before;
      result.bytes_after += packed->bytes.size();
    }
  }
  if (result.packed == 0) return result;
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) list_extension(document.json, list, draco_name);
  const Numbering numbering = renumbering_obstacles(document.json).empty() ? Numbering::may_change : Numbering::kept;
  drop_empty_buffers(document, remove_unused(document, candidates, numbering), numbering);
  return result;
}

}  // namespace nmc::gltf
