// Builds small documents by hand: bytes into buffer 0, views and accessors that describe them.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"
#include "gltf/document.h"

namespace nmc::test {

using gltf::Bytes;
using gltf::Document;
using gltf::Json;

/// A document in the making. Accessors and views are numbered in the order in which they are added.
class ModelBuilder {
 public:
  Json json = {{"asset", {{"version", "2.0"}}}};

  template <typename T>
  int view(const std::vector<T>& values, int stride = 0) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const std::size_t start = bytes_.size();
    bytes_.resize(start + values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bytes_.data() + start, values.data(), values.size() * sizeof(T));
    Json view = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) view["byteStride"] = stride;
    return add("bufferViews", view);
  }

  int accessor(int view, int component_type, const std::string& type, std::size_t count, Json more = Json::object()) {
    Json accessor = {{"componentType", component_type}, {"count", count}, {"type", type}};
    if (view >= 0) accessor["bufferView"] = view;
    accessor.update(more);
    return add("accessors", accessor);
  }

  /// An accessor of floats in a view of its own.
  int floats(const std::string& type, int width, const std::vector<float>& values) {
    return accessor(view(values), 5126, type, values.size() / static_cast<std::size_t>(width));
  }

  int add(const char* list, const Json& object) {
    json[list].push_back(object);
    return static_cast<int>(json[list].size()) - 1;
  }

  /// One animation with one channel that moves `node`.
  void animate(int node, const char* path, int input, int output, const char* interpolation = "LINEAR") {
    add("animations", {{"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                       {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
  }

  /// The document as it is read from a file.
  Document build() const {
    Document document;
    document.name = "built.glb";
    document.is_glb = true;
    document.json = json;
    if (!bytes_.empty()) {
      document.json["buffers"] = {{{"byteLength", bytes_.size()}}};
      document.buffers = {bytes_};
      document.has_data = {true};
    }
    return gltf::parse_document(gltf::to_glb(document), "built.glb", {});
  }

 private:
  Bytes bytes_;
};

/// The Error that a call throws; an Error of kind internal without words when it throws none.
template <typename Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return {ErrorCode::internal, "nothing was thrown"};
}

}  // namespace nmc::test
