// Where a document's JSON refers to accessors, bufferViews and buffers, in core glTF and in the known extensions.
#pragma once

#include <string>
#include <vector>

#include "gltf/document.h"

namespace nmc::gltf {

enum class ObjectKind { accessor, buffer_view, buffer };

/// The member of the JSON root that holds the objects of a kind ("accessors", "bufferViews", "buffers").
const char* array_name(ObjectKind kind);

/// One index in the JSON. The pointer is valid until an object or array around it grows or shrinks.
struct Reference {
  ObjectKind kind = ObjectKind::accessor;
  Json* value = nullptr;
};

/// All references of the document, checked.
/// Throws Error (invalid_input) naming the place where one is no index or out of range.
std::vector<Reference> find_references(Document& document);

/// Why the indices of accessors, bufferViews, buffers and samplers must not change: one clause for each extension that
/// is not known here or whose JSON pointers name such an object. Empty where everything may be renumbered.
std::vector<std::string> renumbering_obstacles(const Json& root);

}  // namespace nmc::gltf
