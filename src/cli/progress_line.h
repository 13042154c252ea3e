// What long work says on standard error: on a terminal one line that is drawn again, with --verbose a line per step.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "base/progress.h"

namespace nmc::cli {

enum class Verbosity {
  quiet,    ///< nothing
  normal,   ///< the line, where standard error is a terminal
  verbose,  ///< also a plain line per step, on a terminal and in a pipe
};

/// The work may have parts (files); each has a share of the whole by what it weighs (bytes).
class ProgressLine {
 public:
  explicit ProgressLine(Verbosity verbosity, std::uint64_t weight_of_all = 1);
  /// `wanted`: false keeps it silent (--quiet).
  explicit ProgressLine(bool wanted) : ProgressLine(wanted ? Verbosity::normal : Verbosity::quiet) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { end(); }

  /// The next part begins; the one before is done. `title` stands before its steps, such as "2/5 fox.glb".
  void begin(const std::string& title, std::uint64_t weight);

  /// The part that has begun took no time (a cache's entry, a failure): it counts as done, and not for the time left.
  void skip();

  /// Removes the line for good.
  void end();

  /// The callback that tells the part's progress; empty where nothing is to be told. Valid as long as this object.
  Progress callback();

 private:
  using Clock = std::chrono::steady_clock;

  void tell(double fraction, std::string_view what);
  void draw();
  void erase();
  double done() const;
  std::string time_text() const;

  const Verbosity verbosity_;
  const bool draws_;
  const std::uint64_t weight_of_all_;
  std::uint64_t weight_before_ = 0, weight_ = 1, weight_skipped_ = 0;
  double fraction_ = 0;
  std::string title_, what_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopped_ = false;
  std::thread ticker_;  ///< draws again every second: the time goes on while nothing is told
};

}  // namespace nmc::cli
