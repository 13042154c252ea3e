#include "cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace nmc::cli {
namespace {

constexpr const char* bold = "\033[1m";
constexpr const char* red = "\033[31m";
constexpr const char* yellow = "\033[33m";
constexpr const char* plain = "\033[0m";

const char* colour_of(std::string_view line, bool is_first) {
  if (line.ends_with("FAILED") || line.ends_with("  NO") || line.starts_with("would fail")) return red;
  if (line.starts_with("note: ") || line.find(": stays") != std::string_view::npos) return yellow;
  return is_first ? bold : nullptr;
}

}  // namespace

bool is_terminal(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return isatty(fileno(stream)) == 1 && term != nullptr && *term != '\0' && std::string_view(term) != "dumb";
}

bool has_colours(std::FILE* stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  return is_terminal(stream) && (no_colour == nullptr || *no_colour == '\0');
}

int terminal_width(std::FILE* stream) {
  winsize size{};
  constexpr int usual_width = 80;
  return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual_width;
}

std::string coloured(const std::string& text) {
  if (!has_colours(stdout)) return text;
  std::string out;
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t end = std::min(text.find('\n', first), text.size());
    const std::string line = text.substr(first, end - first);
    if (const char* colour = colour_of(line, first == 0))
      out += colour + line + plain;
    else
      out += line;
    if (end < text.size()) out += '\n';
    first = end + 1;
  }
  return out;
}

}  // namespace nmc::cli
