// One line on the terminal that is redrawn while long work runs; nothing at all where standard error is no terminal.
#pragma once

#include <chrono>
#include <string_view>

#include "base/progress.h"

namespace nmc::cli {

class ProgressLine {
 public:
  /// `wanted`: false keeps it silent (--quiet).
  explicit ProgressLine(bool wanted);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  /// Removes the line.
  ~ProgressLine();

  /// The callback that draws; empty where nothing is to be drawn. Valid as long as this object.
  Progress callback();

 private:
  void draw(double fraction, std::string_view what);

  bool active_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace nmc::cli
