// Checks buffer views against buffers and accessors against buffer views.
#include <fmt/format.h>

#include "gltf/component.h"
#include "gltf/json_text.h"
#include "gltf/validate.h"

namespace nmc::gltf {
namespace {

/// Elements of an accessor that has no bytes of its own; such accessors are a few bytes of JSON however many elements
/// they claim.
constexpr std::uint64_t most_elements_without_bytes = std::uint64_t{1} << 26;

/// The first part of an accessor or of its sparse storage that lies in a buffer view.
struct Range {
  std::uint64_t offset = 0;
  std::uint64_t count = 0;
  std::uint64_t element = 0;
};

void check_non_empty(const Document& document, const char* key) {
  const Json* list = find_list(document.json, key, document.name);
  if (list != nullptr && list->empty()) Where{document.name, key}.fail("is an empty array, which glTF forbids");
}

void check_view(const Document& document, std::size_t index) {
  const Json& view = document.json["bufferViews"][index];
  const Where where{document.name, fmt::format("bufferViews[{}]", index)};
  const std::size_t buffer = get_index(view, "buffer", document.buffers.size(), where);
  const std::uint64_t offset = find_unsigned(view, "byteOffset", where).value_or(0);
  const std::uint64_t length = get_unsigned(view, "byteLength", where);
  const std::uint64_t size = get_unsigned(document.json["buffers"][buffer], "byteLength", where);
  if (length == 0) where.fail("has a byteLength of 0");
  if (offset > size || length > size - offset) {
    where.fail(
        fmt::format("covers bytes {} to {} of buffers[{}], which has only {}", offset, offset + length, buffer, size));
  }
  const std::optional<std::uint64_t> stride = find_unsigned(view, "byteStride", where);
  if (stride && (*stride < 4 || *stride > 252 || *stride % 4 != 0)) {
    where.fail(fmt::format("has a byteStride of {}, which is not a multiple of 4 from 4 to 252", *stride));
  }
}

void check_range(const Document& document, std::size_t view_index, const Range& range, bool use_stride,
                 const Where& where) {
  const Json& view = document.json["bufferViews"][view_index];
  const Where view_where{document.name, fmt::format("bufferViews[{}]", view_index)};
  const std::uint64_t length = get_unsigned(view, "byteLength", view_where);
  const std::uint64_t stride =
      use_stride ? find_unsigned(view, "byteStride", view_where).value_or(range.element) : range.element;
  if (stride < range.element) {
    where.fail(fmt::format("has elements of {} bytes, more than the byteStride {} of bufferViews[{}]", range.element,
                           stride, view_index));
  }
  // Everything is at most 2^53, and the stride at most 252, so a count that can fit keeps the product within 64 bits.
  const bool fits = range.offset <= length && range.element <= length - range.offset &&
                    range.count - 1 <= (length - range.offset - range.element) / stride;
  if (!fits) {
    where.fail(fmt::format("needs {} elements of {} bytes from byte {} on, but bufferViews[{}] has only {} bytes",
                           range.count, range.element, range.offset, view_index, length));
  }
}

void check_sparse(const Document& document, const Json& sparse, std::uint64_t count, std::uint64_t element,
                  const Where& where) {
  const std::size_t views = list_size(document.json, "bufferViews", document.name);
  const std::uint64_t sparse_count = get_unsigned(sparse, "count", where);
  if (sparse_count == 0 || sparse_count > count) {
    where.fail(fmt::format("replaces {} elements of an accessor with {}", sparse_count, count));
  }
  const Json* indices = find_object(sparse, "indices", where);
  const Json* values = find_object(sparse, "values", where);
  if (indices == nullptr || values == nullptr) where.fail("has no indices or no values");
  const std::uint64_t index_type = get_unsigned(*indices, "componentType", where.at("indices"));
  if (index_type != unsigned_byte && index_type != unsigned_short && index_type != unsigned_int) {
    where.fail(fmt::format("has indices of the component type {}, which is not an unsigned integer", index_type));
  }
  const std::size_t index_view = get_index(*indices, "bufferView", views, where.at("indices"));
  const std::size_t value_view = get_index(*values, "bufferView", views, where.at("values"));
  check_range(document, index_view,
              {find_unsigned(*indices, "byteOffset", where).value_or(0), sparse_count, component_bytes(index_type)},
              false, where.at("indices"));
  check_range(document, value_view, {find_unsigned(*values, "byteOffset", where).value_or(0), sparse_count, element},
              false, where.at("values"));
}

void check_accessor(const Document& document, std::size_t index) {
  const Json& accessor = document.json["accessors"][index];
  const Where where{document.name, fmt::format("accessors[{}]", index)};
  const std::uint64_t component_type = get_unsigned(accessor, "componentType", where);
  const std::uint64_t count = get_unsigned(accessor, "count", where);
  const std::optional<std::string> type = find_string(accessor, "type", where);
  if (!type) where.fail("has no type");
  if (count == 0) where.fail("has a count of 0");
  const Json* normalized = find(accessor, "normalized");
  if (normalized != nullptr && !normalized->is_boolean()) where.fail("has a normalized that is not a boolean");
  if (normalized != nullptr && normalized->get<bool>() &&
      (component_type == float_32 || component_type == unsigned_int)) {
    where.fail("is normalized, which only bytes and shorts can be");
  }
  const std::size_t views = list_size(document.json, "bufferViews", document.name);
  const std::optional<std::size_t> view = find_index(accessor, "bufferView", views, where);
  const std::optional<std::uint64_t> offset = find_unsigned(accessor, "byteOffset", where);
  if (offset && !view) where.fail("has a byteOffset but no bufferView");
  const std::uint64_t element = element_bytes(*type, component_type);
  // Extensions may add types; whoever reads such an accessor refuses it.
  if (element == 0) return;
  if (view) check_range(document, *view, {offset.value_or(0), count, element}, true, where);
  if (!view && count > most_elements_without_bytes)
    where.fail(fmt::format("claims {} elements without any data", count));
  const Json* sparse = find_object(accessor, "sparse", where);
  if (sparse != nullptr) check_sparse(document, *sparse, count, element, where.at("sparse"));
}

}  // namespace

void validate_accessors(const Document& document) {
  for (const char* list : {"buffers", "bufferViews", "accessors"}) check_non_empty(document, list);
  const std::size_t views = list_size(document.json, "bufferViews", document.name);
  for (std::size_t i = 0; i < views; ++i) check_view(document, i);
  const std::size_t accessors = list_size(document.json, "accessors", document.name);
  for (std::size_t i = 0; i < accessors; ++i) check_accessor(document, i);
}

void validate(const Document& document) {
  for (const char* list : {"nodes", "scenes", "meshes", "skins", "animations"}) check_non_empty(document, list);
  validate_accessors(document);
  validate_meshes(document);
  validate_nodes(document);
  validate_animations(document);
}

}  // namespace nmc::gltf
