// Decodes, encodes and resolves URIs.
#include "gltf/uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "base/base64.h"

namespace nmc::gltf {
namespace {

namespace fs = std::filesystem;

std::array<int, 256> base64_values() {
  std::array<int, 256> values{};
  values.fill(-1);
  for (std::size_t i = 0; i < base64_letters.size(); ++i)
    values[static_cast<unsigned char>(base64_letters[i])] = static_cast<int>(i);
  return values;
}

std::optional<Bytes> decode_base64(std::string_view text) {
  static const std::array<int, 256> values = base64_values();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = (bits << 6 | static_cast<std::uint32_t>(value)) & 0xFFFFFF;
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> bit_count));
  }
  return bytes;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  const auto [folder_end, unused] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return folder_end == folder.end();
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return lower(uri.substr(0, 5)) == "data:"; }

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find_first_of(":/?#");
  return colon != std::string_view::npos && uri[colon] == ':';
}

std::optional<std::string> percent_decode(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    const int high = i + 2 < text.size() ? hex_value(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_value(text[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    out.push_back(static_cast<char>(high * 16 + low));
    i += 2;
  }
  return out;
}

std::string percent_encode(std::string_view text) {
  constexpr std::string_view hex = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && (std::isalnum(byte) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos)) {
      out.push_back(c);
    } else {
      out += {'%', hex[byte >> 4], hex[byte & 15]};
    }
  }
  return out;
}

std::optional<Bytes> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string media_type = lower(uri.substr(5, comma - 5));
  if (media_type.find(";;") != std::string::npos) return std::nullopt;
  const std::string_view data = uri.substr(comma + 1);
  if (media_type.ends_with(";base64")) {
    // RFC 3986 lets any character of a URI be percent-encoded, and some exporters do so with '+' and '='.
    if (data.find('%') == std::string_view::npos) return decode_base64(data);
    const std::optional<std::string> text = percent_decode(data);
    return text ? decode_base64(*text) : std::nullopt;
  }
  const std::optional<std::string> text = percent_decode(data);
  if (!text) return std::nullopt;
  return Bytes(text->begin(), text->end());
}

std::string encode_data_uri(std::span<const std::uint8_t> bytes) {
  return "data:application/octet-stream;base64," + base64(bytes);
}

std::optional<fs::path> resolve_uri(std::string_view uri, const fs::path& folder, bool allow_external) {
  if (uri.empty() || has_scheme(uri)) return std::nullopt;
  const std::optional<std::string> text = percent_decode(uri);
  if (!text || text->find('\0') != std::string::npos) return std::nullopt;
  const fs::path root = folder.empty() ? fs::path(".") : folder;
  const fs::path path = (root / fs::path(*text)).lexically_normal();
  if (allow_external) return path;
  std::error_code error;
  const fs::path real_root = fs::weakly_canonical(fs::absolute(root, error), error);
  if (error) return std::nullopt;
  const fs::path real_path = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error || !is_inside(real_path, real_root)) return std::nullopt;
  return path;
}

}  // namespace nmc::gltf
