// Unpacks meshopt-compressed buffer views with meshoptimizer, after checking what its decoders only assert.
#include "gltf/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>

#include "base/error.h"
#include "gltf/json_text.h"

namespace nmc::gltf {
namespace {

/// The properties of the extension object (EXT_meshopt_compression, "Specifying compressed views").
struct Packing {
  std::span<const std::uint8_t> bytes;
  std::uint64_t count = 0;
  std::uint64_t stride = 0;
  std::string mode;
  std::string filter;
};

const Json* find_extension(const Json& view, const Where& where) {
  const Json* extensions = find_object(view, "extensions", where);
  if (extensions == nullptr) return nullptr;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (const Json* extension = find_object(*extensions, name, where)) return extension;
  }
  return nullptr;
}

std::span<const std::uint8_t> packed_bytes(const Document& document, const Json& extension, const Where& where) {
  const std::size_t buffer = get_index(extension, "buffer", document.buffers.size(), where);
  const std::uint64_t offset = find_unsigned(extension, "byteOffset", where).value_or(0);
  const std::uint64_t length = get_unsigned(extension, "byteLength", where);
  const Bytes& bytes = document.buffers[buffer];
  if (!document.has_data[buffer])
    where.fail(fmt::format("has its packed bytes in buffers[{}], which has no data", buffer));
  if (offset > bytes.size() || length > bytes.size() - offset)
    where.fail(fmt::format("has packed bytes outside buffers[{}]", buffer));
  return std::span(bytes).subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

/// The smallest number of packed bytes per element that the formats allow, as a bound before memory is allocated:
/// vertex data has two bits per 16 values and byte of the element, triangles have a code byte each, and sequences at
/// least a byte per index.
bool is_plausible(const Packing& packing) {
  const std::uint64_t packed = packing.bytes.size();
  if (packing.mode == "ATTRIBUTES") return packing.count / 64 * packing.stride / 64 <= packed;
  return packing.count / 3 <= packed;
}

void check_packing(const Packing& packing, std::uint64_t view_length, const Where& where) {
  if (packing.mode != "ATTRIBUTES" && packing.mode != "TRIANGLES" && packing.mode != "INDICES") {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: {} has the unknown mode \"{}\".", where.file_name, where.object, packing.mode));
  }
  if (packing.filter != "NONE" && packing.filter != "OCTAHEDRAL" && packing.filter != "QUATERNION" &&
      packing.filter != "EXPONENTIAL") {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: {} has the unknown filter \"{}\".", where.file_name, where.object, packing.filter));
  }
  const bool is_vertices = packing.mode == "ATTRIBUTES";
  const bool stride_fits = is_vertices ? packing.stride > 0 && packing.stride % 4 == 0 && packing.stride <= 256
                                       : packing.stride == 2 || packing.stride == 4;
  const bool filter_fits = packing.filter == "NONE" ||
                           (packing.filter == "OCTAHEDRAL" && (packing.stride == 4 || packing.stride == 8)) ||
                           (packing.filter == "QUATERNION" && packing.stride == 8) || packing.filter == "EXPONENTIAL";
  if (!stride_fits || !filter_fits || (!is_vertices && packing.filter != "NONE")) {
    where.fail(fmt::format("has a byteStride of {}, which does not fit its mode and filter", packing.stride));
  }
  if (packing.mode == "TRIANGLES" && packing.count % 3 != 0)
    where.fail("has triangles with a count that is no multiple of 3");
  if (packing.count == 0 || packing.count > view_length / packing.stride ||
      packing.count * packing.stride != view_length) {
    where.fail(fmt::format("unpacks to {} elements of {} bytes, but the view has {} bytes", packing.count,
                           packing.stride, view_length));
  }
  if (!is_plausible(packing)) where.fail("claims more elements than its packed bytes can hold");
}

void apply_filter(const Packing& packing, Bytes& out) {
  const auto count = static_cast<std::size_t>(packing.count);
  const auto stride = static_cast<std::size_t>(packing.stride);
  if (packing.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
  if (packing.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count, stride);
  if (packing.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
}

/// The filters work on whole groups of four elements, so that they may read and write a little past the end.
constexpr std::size_t filter_slack_bytes = 3 * 256;

}  // namespace

std::optional<Bytes> unpack_meshopt(const Document& document, std::size_t buffer_view) {
  const Json& view = document.json["bufferViews"][buffer_view];
  const Where where{document.name, fmt::format("bufferViews[{}]", buffer_view)};
  const Json* extension = find_extension(view, where);
  if (extension == nullptr) return std::nullopt;
  Packing packing;
  packing.bytes = packed_bytes(document, *extension, where);
  packing.count = get_unsigned(*extension, "count", where);
  packing.stride = get_unsigned(*extension, "byteStride", where);
  packing.mode = find_string(*extension, "mode", where).value_or("");
  packing.filter = find_string(*extension, "filter", where).value_or("NONE");
  const std::uint64_t length = get_unsigned(view, "byteLength", where);
  check_packing(packing, length, where);

  Bytes out(static_cast<std::size_t>(length) + filter_slack_bytes);
  const auto count = static_cast<std::size_t>(packing.count);
  const auto stride = static_cast<std::size_t>(packing.stride);
  int result = 0;
  if (packing.mode == "ATTRIBUTES") {
    result = meshopt_decodeVertexBuffer(out.data(), count, stride, packing.bytes.data(), packing.bytes.size());
  } else if (packing.mode == "TRIANGLES") {
    result = meshopt_decodeIndexBuffer(out.data(), count, stride, packing.bytes.data(), packing.bytes.size());
  } else {
    result = meshopt_decodeIndexSequence(out.data(), count, stride, packing.bytes.data(), packing.bytes.size());
  }
  if (result != 0) where.fail("has meshopt data that does not decode");
  apply_filter(packing, out);
  out.resize(static_cast<std::size_t>(length));
  return out;
}

}  // namespace nmc::gltf
