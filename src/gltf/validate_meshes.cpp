// Checks the attributes and morph targets of meshes.
#include <fmt/format.h>

#include <string_view>

#include "gltf/component.h"
#include "gltf/json_text.h"
#include "gltf/validate.h"

namespace nmc::gltf {
namespace {

const Json& accessor_at(const Document& document, std::size_t index) { return document.json["accessors"][index]; }

double number(const Json& accessor, const char* key) { return accessor[key].get<double>(); }

bool uses_extension(const Document& document, std::string_view name) {
  const Json* used = find(document.json, "extensionsUsed");
  if (used == nullptr || !used->is_array()) return false;
  for (const Json& extension : *used) {
    if (extension.is_string() && extension.get_ref<const std::string&>() == name) return true;
  }
  return false;
}

/// The types of POSITION, JOINTS_n and WEIGHTS_n (glTF 2.0, section 3.7.2.1; KHR_mesh_quantization allows integers for
/// POSITION).
void check_format(const Document& document, const std::string& semantic, const Json& accessor, const Where& where) {
  const auto& type = accessor["type"].get_ref<const std::string&>();
  const auto component = static_cast<std::uint64_t>(number(accessor, "componentType"));
  const bool normalized = accessor.value("normalized", false);
  bool good = true;
  if (semantic == "POSITION") {
    good = type == "VEC3" &&
           (component == float_32 || (component < unsigned_int && uses_extension(document, "KHR_mesh_quantization")));
  } else if (semantic.starts_with("JOINTS_")) {
    good = type == "VEC4" && (component == unsigned_byte || component == unsigned_short) && !normalized;
  } else if (semantic.starts_with("WEIGHTS_")) {
    good = type == "VEC4" &&
           (component == float_32 || ((component == unsigned_byte || component == unsigned_short) && normalized));
  }
  if (!good) where.fail(fmt::format("has a {} of a type that glTF does not allow there", semantic));
}

/// Checks the accessors of an attributes object and returns their common count.
std::uint64_t check_attributes(const Document& document, const Json& attributes, const Where& where) {
  const std::size_t accessors = list_size(document.json, "accessors", document.name);
  if (attributes.empty()) where.fail("has no attributes");
  double count = 0;
  for (const auto& [semantic, value] : attributes.items()) {
    const Json& accessor = accessor_at(document, as_index(value, accessors, where, semantic));
    const double this_count = number(accessor, "count");
    if (count != 0 && this_count != count)
      where.fail(fmt::format("has a {} with another count than its other attributes", semantic));
    count = this_count;
    check_format(document, semantic, accessor, where);
  }
  return static_cast<std::uint64_t>(count);
}

void check_joint_sets(const Json& attributes, const Where& where) {
  std::size_t joints = 0;
  std::size_t weights = 0;
  while (attributes.contains(fmt::format("JOINTS_{}", joints))) ++joints;
  while (attributes.contains(fmt::format("WEIGHTS_{}", weights))) ++weights;
  if (joints != weights) where.fail(fmt::format("has {} sets of joints but {} sets of weights", joints, weights));
}

std::size_t check_targets(const Document& document, const Json& primitive, std::uint64_t count, const Where& where) {
  const Json* targets = find_array(primitive, "targets", where);
  if (targets == nullptr) return 0;
  if (targets->empty()) where.fail("has empty targets, which glTF forbids");
  for (std::size_t i = 0; i < targets->size(); ++i) {
    const Json& target = (*targets)[i];
    const Where target_where = where.at("targets", i);
    if (!target.is_object()) target_where.fail("is not an object");
    if (check_attributes(document, target, target_where) != count)
      target_where.fail("has another count of vertices than the mesh");
    for (const auto& [semantic, value] : target.items()) {
      if (!primitive["attributes"].contains(semantic))
        target_where.fail(fmt::format("moves {}, which the mesh does not have", semantic));
    }
  }
  return targets->size();
}

void check_draco(const Document& document, const Json& primitive, const Where& where) {
  const Json* extensions = find_object(primitive, "extensions", where);
  const Json* draco = extensions == nullptr ? nullptr : find_object(*extensions, "KHR_draco_mesh_compression", where);
  if (draco == nullptr) return;
  get_index(*draco, "bufferView", list_size(document.json, "bufferViews", document.name), where);
  const Json* attributes = find_object(*draco, "attributes", where);
  if (attributes == nullptr) where.fail("has a KHR_draco_mesh_compression without attributes");
  for (const auto& [semantic, value] : attributes->items()) {
    as_index(value, std::uint64_t{1} << 32, where, semantic);
    if (!primitive["attributes"].contains(semantic))
      where.fail(fmt::format("compresses {}, which it does not have", semantic));
  }
}

/// Checks a primitive and returns its number of morph targets.
std::size_t check_primitive(const Document& document, const Json& primitive, const Where& where) {
  const Json* attributes = find_object(primitive, "attributes", where);
  if (attributes == nullptr) where.fail("has no attributes");
  const std::uint64_t count = check_attributes(document, *attributes, where);
  check_joint_sets(*attributes, where);
  find_index(primitive, "indices", list_size(document.json, "accessors", document.name), where);
  check_draco(document, primitive, where);
  return check_targets(document, primitive, count, where);
}

}  // namespace

void validate_meshes(const Document& document) {
  const Json* meshes = find_list(document.json, "meshes", document.name);
  for (std::size_t i = 0; meshes != nullptr && i < meshes->size(); ++i) {
    const Json& mesh = (*meshes)[i];
    const Where where{document.name, fmt::format("meshes[{}]", i)};
    const Json* primitives = find_array(mesh, "primitives", where);
    if (primitives == nullptr || primitives->empty()) where.fail("has no primitives");
    std::size_t targets = 0;
    for (std::size_t p = 0; p < primitives->size(); ++p) {
      const Where primitive_where = where.at("primitives", p);
      if (!(*primitives)[p].is_object()) primitive_where.fail("is not an object");
      const std::size_t count = check_primitive(document, (*primitives)[p], primitive_where);
      if (p > 0 && count != targets)
        primitive_where.fail("has another number of morph targets than the first primitive");
      targets = count;
    }
    const Json* weights = find_array(mesh, "weights", where);
    bool good = weights == nullptr || weights->size() == targets;
    for (std::size_t w = 0; good && weights != nullptr && w < weights->size(); ++w) good = (*weights)[w].is_number();
    if (!good) where.fail(fmt::format("has weights that are not {} numbers, one per morph target", targets));
  }
}

}  // namespace nmc::gltf
