// Unpacks buffer views that EXT_meshopt_compression or KHR_meshopt_compression has packed.
#pragma once

#include <optional>

#include "gltf/document.h"

namespace nmc::gltf {

/// The unpacked bytes of a buffer view, or an empty optional when the view is not packed.
/// Throws Error: invalid_input naming the view (properties that do not fit together, bytes that do not decode),
/// unsupported (a mode or filter of a later version of the extension).
std::optional<Bytes> unpack_meshopt(const Document& document, std::size_t buffer_view);

}  // namespace nmc::gltf
