#include "base/platform.h"

#ifdef __EMSCRIPTEN__
#include <emscripten.h>

#include <cstdlib>
#include <memory>
#endif

namespace nmc {

#ifdef __EMSCRIPTEN__

// Whoever loads the WebAssembly says where it came from; /proc/self/exe would be Node.
std::string program_path() {
  const auto make = [] {
    return reinterpret_cast<char*>(EM_ASM_INT({
      const text = Module['thisProgram'];
      const bytes = lengthBytesUTF8(text) + 1;
      const at = _malloc(bytes);
      stringToUTF8(text, at, bytes);
      return at;
    }));
  };
  const std::unique_ptr<char, void (*)(void*)> path(make(), std::free);
  return path.get();
}

#else

std::string program_path() { return "/proc/self/exe"; }

#endif

}  // namespace nmc
