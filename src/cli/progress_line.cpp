#include "cli/progress_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "base/platform.h"
#include "cli/terminal.h"
#include "report/format.h"

namespace nmc::cli {
namespace {

constexpr auto redraw_interval = std::chrono::milliseconds(500);
constexpr int widest_line = 100;
constexpr int bar_width = 20;

/// "4:07", "1:02:33".
std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::llround(std::min(seconds, 359'999.0)));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string bar(double fraction) {
  const int full = static_cast<int>(std::lround(fraction * bar_width));
  return fmt::format("[{}{}]", std::string(static_cast<std::size_t>(full), '#'),
                     std::string(static_cast<std::size_t>(bar_width - full), '.'));
}

}  // namespace

ProgressLine::ProgressLine(Verbosity verbosity, std::uint64_t weight_of_all)
    : verbosity_(verbosity),
      draws_(verbosity != Verbosity::quiet && is_terminal(stderr)),
      weight_of_all_(std::max<std::uint64_t>(1, weight_of_all)),
      weight_(weight_of_all_) {
  if (!draws_ || !has_threads) return;
  try {
    ticker_ = std::thread([this] {
      std::unique_lock lock(mutex_);
      while (!stop_.wait_for(lock, redraw_interval, [this] { return stopped_; })) draw();
    });
  } catch (const std::system_error&) {
    // Without another thread the line is drawn when something is told.
  }
}

void ProgressLine::end() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    erase();
  }
  stop_.notify_all();
  if (ticker_.joinable()) ticker_.join();
}

void ProgressLine::begin(const std::string& title, std::uint64_t weight) {
  const std::lock_guard lock(mutex_);
  if (!title_.empty()) weight_before_ += weight_;
  title_ = title;
  weight_ = weight;
  fraction_ = 0;
  what_.clear();
}

void ProgressLine::skip() {
  const std::lock_guard lock(mutex_);
  weight_skipped_ += weight_;
  fraction_ = 1;
  erase();  // what the caller has to say about it stands on a line of its own
}

Progress ProgressLine::callback() {
  if (!draws_ && verbosity_ != Verbosity::verbose) return {};
  return [this](double fraction, std::string_view what) { tell(fraction, what); };
}

void ProgressLine::tell(double fraction, std::string_view what) {
  const std::lock_guard lock(mutex_);
  fraction_ = std::max(fraction_, std::clamp(fraction, 0.0, 1.0));  // a second pass over some clips starts again
  what_ = report::printable(what);
  if (verbosity_ == Verbosity::verbose) {
    erase();
    fmt::print(stderr, "{:3.0f}% {}{}{}\n", 100 * done(), report::printable(title_), title_.empty() ? "" : ": ", what_);
    std::fflush(stderr);
  }
  if (draws_ && !stopped_) draw();
}

double ProgressLine::done() const {
  const double weight = static_cast<double>(weight_before_) + fraction_ * static_cast<double>(weight_);
  return std::min(1.0, weight / static_cast<double>(weight_of_all_));
}

/// The time left, by the time that what was done has taken; the time spent while nothing is done yet.
std::string ProgressLine::time_text() const {
  const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
  const double all = static_cast<double>(weight_of_all_);
  const double worked = done() - static_cast<double>(weight_skipped_) / all;
  if (worked <= 0) return fmt::format("{} spent", clock_text(spent));
  return fmt::format("{} left", clock_text(spent * (1 - done()) / worked));
}

void ProgressLine::draw() {
  // A line that reaches the last column would be wrapped and could not be drawn again.
  const int width = std::min(terminal_width(stderr) - 1, widest_line);
  const std::string head = fmt::format("{:3.0f}% {} {}", 100 * done(), bar(done()), time_text());
  const std::string tail = title_.empty() || what_.empty() ? title_ + what_ : title_ + ": " + what_;
  const std::string line = report::shorten(fmt::format("{}  {}", head, report::printable(tail)),
                                           static_cast<std::size_t>(std::max(1, width)));
  fmt::print(stderr, "\r\033[K{}", line);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressLine::erase() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace nmc::cli
