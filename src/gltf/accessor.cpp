// Reads accessors: components of every type, strides, sparse replacements.
#include "gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "gltf/component.h"

namespace nmc::gltf {
namespace {

/// Elements in memory, `stride` bytes apart.
struct Elements {
  const std::uint8_t* first = nullptr;
  std::size_t stride = 0;
};

template <typename T>
float load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return static_cast<float>(value);
}

float read_component(const std::uint8_t* at, int type, bool normalized) {
  switch (type) {
    case signed_byte:
      return normalized ? std::max(load<std::int8_t>(at) / 127.0f, -1.0f) : load<std::int8_t>(at);
    case unsigned_byte:
      return normalized ? load<std::uint8_t>(at) / 255.0f : load<std::uint8_t>(at);
    case signed_short:
      return normalized ? std::max(load<std::int16_t>(at) / 32767.0f, -1.0f) : load<std::int16_t>(at);
    case unsigned_short:
      return normalized ? load<std::uint16_t>(at) / 65535.0f : load<std::uint16_t>(at);
    case unsigned_int:
      return load<std::uint32_t>(at);
    default:
      return load<float>(at);
  }
}

std::string type_name(const tinygltf::Accessor& accessor) {
  switch (accessor.type) {
    case TINYGLTF_TYPE_SCALAR:
      return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
      return "VEC2";
    case TINYGLTF_TYPE_VEC3:
      return "VEC3";
    case TINYGLTF_TYPE_VEC4:
      return "VEC4";
    case TINYGLTF_TYPE_MAT2:
      return "MAT2";
    case TINYGLTF_TYPE_MAT3:
      return "MAT3";
    default:
      return "MAT4";
  }
}

/// Where elements lie, checked against the buffer once more: the document was validated, this guards the copy.
Elements locate(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
                std::size_t element, bool use_stride) {
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(view_index));
  const std::vector<unsigned char>& bytes = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  const std::size_t stride = use_stride && view.byteStride != 0 ? view.byteStride : element;
  const std::size_t start = view.byteOffset + offset;
  const std::size_t span = (count - 1) * stride + element;
  if (count == 0 || start > bytes.size() || span > bytes.size() - start) {
    throw Error(ErrorCode::internal, "an accessor of the prepared copy lies outside its buffer");
  }
  return {bytes.data() + start, stride};
}

/// Reads one element. Each column of a matrix of small components is padded to four bytes.
void read_element(const std::uint8_t* at, const tinygltf::Accessor& accessor, int width, float* out) {
  const auto component = static_cast<std::size_t>(component_bytes(static_cast<std::uint64_t>(accessor.componentType)));
  const int rows = accessor.type == TINYGLTF_TYPE_MAT2 ? 2 : accessor.type == TINYGLTF_TYPE_MAT3 ? 3 : width;
  const std::size_t column_bytes = rows == width ? 0 : (static_cast<std::size_t>(rows) * component + 3) / 4 * 4;
  for (int i = 0; i < width; ++i) {
    const std::size_t byte =
        static_cast<std::size_t>(i / rows) * column_bytes + static_cast<std::size_t>(i % rows) * component;
    out[i] = read_component(at + byte, accessor.componentType, accessor.normalized);
  }
}

void read_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, int width, std::size_t element,
                 std::vector<float>& values, const Where& where) {
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  const auto index_bytes =
      static_cast<std::size_t>(component_bytes(static_cast<std::uint64_t>(sparse.indices.componentType)));
  const Elements indices = locate(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                                  count, index_bytes, false);
  const Elements replacements = locate(model, sparse.values.bufferView,
                                       static_cast<std::size_t>(sparse.values.byteOffset), count, element, false);
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t index = 0;
    for (std::size_t b = 0; b < index_bytes; ++b) {
      index |= static_cast<std::uint32_t>(indices.first[i * indices.stride + b]) << (8 * b);
    }
    if (index < next || index >= accessor.count)
      where.fail(fmt::format("has the sparse index {} out of order or range", index));
    next = std::uint64_t{index} + 1;
    read_element(replacements.first + i * replacements.stride, accessor, width,
                 values.data() + std::size_t{index} * static_cast<std::size_t>(width));
  }
}

}  // namespace

int width_of(const tinygltf::Accessor& accessor) { return component_count(type_name(accessor)); }

std::vector<float> read_floats(const tinygltf::Model& model, int index, const std::string& file_name) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  const Where where{file_name, fmt::format("accessors[{}]", index)};
  const int width = width_of(accessor);
  const auto element =
      static_cast<std::size_t>(element_bytes(type_name(accessor), static_cast<std::uint64_t>(accessor.componentType)));
  std::vector<float> values(accessor.count * static_cast<std::size_t>(width), 0.0f);
  if (accessor.bufferView >= 0) {
    const Elements elements = locate(model, accessor.bufferView, accessor.byteOffset, accessor.count, element, true);
    for (std::size_t i = 0; i < accessor.count; ++i) {
      read_element(elements.first + i * elements.stride, accessor, width,
                   values.data() + i * static_cast<std::size_t>(width));
    }
  }
  if (accessor.sparse.isSparse) read_sparse(model, accessor, width, element, values, where);
  const auto bad = std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
  if (bad != values.end()) {
    where.fail(fmt::format("has an element {} that is not a finite number", (bad - values.begin()) / width));
  }
  return values;
}

}  // namespace nmc::gltf
