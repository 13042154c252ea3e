// URIs of glTF files: data URIs, percent encoding, and paths that must stay inside a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gltf/document.h"

namespace nmc::gltf {

/// True for "data:..." (case does not matter).
bool is_data_uri(std::string_view uri);

/// True for any URI that names a scheme (http:, file:, data:, ...).
bool has_scheme(std::string_view uri);

/// The bytes of a data URI, base64 or percent-encoded (RFC 2397). Empty optional when it is malformed.
std::optional<Bytes> decode_data_uri(std::string_view uri);

/// "data:application/octet-stream;base64,..." (glTF 2.0, section 3.6.1.2).
std::string encode_data_uri(std::span<const std::uint8_t> bytes);

/// Undoes %XX. Empty optional for a stray '%' or a NUL.
std::optional<std::string> percent_decode(std::string_view text);

/// Encodes everything but letters, digits and "-._~/" (RFC 3986).
std::string percent_encode(std::string_view text);

/// Where a relative URI leads from `folder`: the path as written (not canonical), or an empty optional if it is
/// malformed, has a scheme, or (unless `allow_external`) leads out of the folder after normalisation and after
/// following symbolic links.
std::optional<std::filesystem::path> resolve_uri(std::string_view uri, const std::filesystem::path& folder,
                                                 bool allow_external);

}  // namespace nmc::gltf
