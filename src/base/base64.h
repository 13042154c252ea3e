// Bytes as base64 (RFC 4648, section 4), with padding.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace nmc {

/// The letter of each value from 0 to 63.
inline constexpr std::string_view base64_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace nmc
