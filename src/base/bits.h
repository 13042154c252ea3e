// std::bit_cast, also where the standard library has none yet (libc++ before 14).
#pragma once

#include <bit>
#include <cstring>
#include <type_traits>

namespace nmc {

#ifdef __cpp_lib_bit_cast
using std::bit_cast;
#else
/// The value of type To with the bytes of `from`.
template <typename To, typename From>
To bit_cast(const From& from) {
  static_assert(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> && std::is_trivially_copyable_v<From>);
  To to;
  std::memcpy(&to, &from, sizeof(To));
  return to;
}
#endif

}  // namespace nmc
