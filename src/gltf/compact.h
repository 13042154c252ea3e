// Takes accessors, bufferViews and their bytes out of a document when nothing refers to them any more.
#pragma once

#include <cstddef>
#include <set>

#include "gltf/document.h"

namespace nmc::gltf {

/// Whether objects may move to other places in their arrays. `kept` is for files with extensions that may refer to them
/// unseen.
enum class Numbering { may_change, kept };

/// Objects that an edit may have made superfluous.
struct Candidates {
  std::set<std::size_t> accessors;
  std::set<std::size_t> buffer_views;
};

/// Removes those candidates, and the bufferViews of removed accessors, that nothing refers to. Bytes that only removed
/// views held are cut out of their buffers, with bytes of no view that lie next to them; all other views keep their
/// bytes, and their offsets modulo 8. Buffers that lost no view are not touched. With numbering kept, a removed object
/// stays as the smallest valid one. Meshopt-compressed views count with the bytes that their extension object names.
/// Returns the buffers that lost a view, to be passed to drop_empty_buffers when the edit is complete.
/// Throws Error (invalid_input) for references and ranges that do not fit.
std::set<std::size_t> remove_unused(Document& document, const Candidates& candidates, Numbering numbering);

/// Removes those of `buffers` that hold nothing and that nothing refers to. One that has to stay gets four zero bytes.
void drop_empty_buffers(Document& document, const std::set<std::size_t>& buffers, Numbering numbering);

}  // namespace nmc::gltf
