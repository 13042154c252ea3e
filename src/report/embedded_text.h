// The texts that the build puts into the program: the HTML report's page, style and scripts, and the JavaScript
// decoder.
#pragma once

#include <string_view>

namespace nmc::report {

/// A text by its file name in src/report/html, or "nmc/<file>" of gltf_ext/js/src. Defined by embed.cmake's output.
std::string_view embedded_text(std::string_view name);

}  // namespace nmc::report
