#include "cli/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "report/format.h"

namespace nmc::cli {
namespace {

constexpr auto redraw_interval = std::chrono::milliseconds(100);
constexpr std::size_t line_width = 72;  // fits the narrowest usual terminal: a wrapped line could not be redrawn

}  // namespace

ProgressLine::ProgressLine(bool wanted) : active_(wanted && isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

Progress ProgressLine::callback() {
  if (!active_) return {};
  return [this](double fraction, std::string_view what) { draw(fraction, what); };
}

void ProgressLine::draw(double fraction, std::string_view what) {
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && now - last_ < redraw_interval) return;
  last_ = now;
  drawn_ = true;
  const std::string line = fmt::format("{:3.0f}% {}", 100 * std::clamp(fraction, 0.0, 1.0), report::printable(what));
  fmt::print(stderr, "\r\033[K{}", report::shorten(line, line_width));
  std::fflush(stderr);
}

}  // namespace nmc::cli
