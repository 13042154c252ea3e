// How long work tells what it is doing without knowing whether anyone looks.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <string_view>

namespace nmc {

/// Called with a fraction in [0, 1] and what is being done now. May be empty. Called from one thread at a time.
using Progress = std::function<void(double fraction, std::string_view what)>;

/// Progress in equal steps that several threads take.
class StepProgress {
 public:
  /// `progress` must outlive it.
  StepProgress(const Progress& progress, std::size_t steps) : progress_(progress), steps_(steps) {}

  /// One more step is done.
  void done(std::string_view what) {
    if (!progress_) return;
    const std::lock_guard lock(mutex_);
    progress_(static_cast<double>(++done_) / static_cast<double>(steps_), what);
  }

 private:
  const Progress& progress_;
  std::size_t steps_, done_ = 0;
  std::mutex mutex_;
};

}  // namespace nmc
