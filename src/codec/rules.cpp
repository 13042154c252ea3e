#include "codec/rules.h"

#include <cstddef>

namespace nmc::codec {

bool matches(std::string_view pattern, std::string_view name) {
  // The last star takes one character more whenever what follows it does not fit.
  std::size_t p = 0, n = 0, after_star = std::string_view::npos, taken = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      after_star = ++p;
      taken = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (after_star != std::string_view::npos) {
      p = after_star;
      n = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

bool selects_clip(const Selector& selector, std::string_view clip) {
  return selector.clip.empty() || matches(selector.clip, clip);
}

bool selects_channel(const Selector& selector, std::string_view joint, Path path) {
  return (selector.joint.empty() || matches(selector.joint, joint)) && (!selector.path || *selector.path == path);
}

}  // namespace nmc::codec
