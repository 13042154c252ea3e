#include "baselines/comparison.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel.h"
#include "base/platform.h"

namespace nmc::baselines {
namespace {

constexpr int coarser_octaves = 5, finer_octaves = 12;  // how far from the tolerance a knob is looked for
constexpr double precision_octaves = 1.0 / 16;
constexpr int idle_octaves = 3;  // without a smaller error, the method has reached its floor

/// Of this thread alone: what other methods do meanwhile does not count. A program without threads has no clock for
/// them, and does nothing meanwhile.
double thread_seconds() {
  timespec now{};
  clock_gettime(has_threads ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One method at work: every encoding that it made, by knob.
class Trial {
 public:
  Trial(const codec::Source& source, const motion::ErrorMeter& meter, const Method& method, int effort)
      : source_(source), meter_(meter), method_(method) {
    const double start = thread_seconds();
    encoder_ = method.prepare(source, {.effort = effort, .threads = 1});
    prepare_seconds_ = thread_seconds() - start;
  }

  const Encoding& at(double knob) {
    const auto found = made_.find(knob);
    if (found != made_.end()) return found->second;
    const double start = thread_seconds();
    Bytes bytes = encoder_->encode(knob);
    const double seconds = thread_seconds() - start;
    Encoding encoding = judge(source_, meter_, method_, std::move(bytes));
    encoding.knob = knob;
    encoding.encode_seconds = prepare_seconds_ + seconds;
    return made_.emplace(knob, std::move(encoding)).first->second;
  }

  /// Makes what is needed to know the fewest bytes within a tolerance (share of size).
  void reach(double tolerance) {
    const double bound = tolerance * source_.size;
    const auto holds = [&](double octaves) { return at(tolerance * std::exp2(octaves)).max_error <= bound; };
    if (method_.keeps_bound) {
      holds(0);
      return;
    }
    double coarse = 0, fine = 0;  // octaves: fine holds, coarse does not
    if (holds(0)) {
      for (coarse = 1; coarse <= coarser_octaves && holds(coarse); ++coarse) fine = coarse;
      if (coarse > coarser_octaves) return;
    } else {
      double least = at(tolerance).max_error;
      int idle = 0;
      for (fine = -1; !holds(fine); --fine) {
        const double error = at(tolerance * std::exp2(fine)).max_error;
        idle = error < 0.99 * least ? 0 : idle + 1;
        least = std::min(least, error);
        if (idle >= idle_octaves || fine <= -finer_octaves) return;
        coarse = fine;
      }
    }
    while (coarse - fine > precision_octaves) {
      const double middle = (coarse + fine) / 2;
      (holds(middle) ? fine : coarse) = middle;
    }
  }

  std::map<double, Encoding> take() { return std::move(made_); }

 private:
  const codec::Source& source_;
  const motion::ErrorMeter& meter_;
  const Method& method_;
  std::unique_ptr<Encoder> encoder_;
  double prepare_seconds_ = 0;
  std::map<double, Encoding> made_;
};

/// What runs on its own: all tolerances of a method, or one of those that share nothing.
struct Task {
  std::size_t method = 0;
  std::vector<double> tolerances;
  std::map<double, Encoding> made;
  std::string failure;
};

std::vector<Task> make_tasks(const CompareOptions& options) {
  std::vector<Task> tasks;
  for (std::size_t m = 0; m < options.methods.size(); ++m) {
    if (options.methods[m]->name != "nmc") {
      tasks.push_back({m, options.tolerances, {}, {}});
      continue;
    }
    for (const double tolerance : options.tolerances) tasks.push_back({m, {tolerance}, {}, {}});
  }
  return tasks;
}

void choose_best(MethodResult& result, const std::vector<double>& tolerances, double size) {
  for (const double tolerance : tolerances) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < result.curve.size(); ++i) {
      const Encoding& made = result.curve[i];
      if (made.max_error <= tolerance * size && (!best || made.bytes.size() < result.curve[*best].bytes.size()))
        best = i;
    }
    result.best.push_back(best);
  }
}

}  // namespace

Encoding judge(const codec::Source& source, const motion::ErrorMeter& meter, const Method& method, Bytes bytes) {
  Encoding encoding;
  const double start = thread_seconds();
  const std::vector<motion::Clip> clips = method.decode(bytes, source.skeleton);
  encoding.decode_seconds = thread_seconds() - start;
  encoding.bytes = std::move(bytes);
  if (clips.size() != source.clips.size())
    throw Error(ErrorCode::invalid_input, "the encoded motion has another number of clips than the file");
  double frames = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const codec::ClipSource& from = source.clips[i];
    const motion::ErrorReport report = meter.report(from.original, codec::with_kept(from, clips[i]));
    const auto count = static_cast<double>(from.clip.times.size());
    encoding.max_error = std::max(encoding.max_error, report.max);
    encoding.max_joint = std::max(encoding.max_joint, report.max_joint);
    encoding.mean_error += count * report.mean;
    frames += count;
  }
  encoding.mean_error /= std::max(1.0, frames);
  return encoding;
}

Comparison compare(const codec::Source& source, const CompareOptions& options) {
  Comparison result;
  result.tolerances = options.tolerances;
  result.size = source.size;
  result.clips = source.clips.size();
  for (const codec::ClipSource& clip : source.clips) result.frames += clip.clip.times.size();
  const motion::ErrorMeter meter(source.skeleton, source.all_points);
  std::vector<Task> tasks = make_tasks(options);
  StepProgress progress(options.progress, options.methods.size() * options.tolerances.size());
  parallel_for(tasks.size(), options.threads, [&](std::size_t i) {
    Task& task = tasks[i];
    const Method& method = *options.methods[task.method];
    try {
      Trial trial(source, meter, method, options.effort);
      for (const double tolerance : task.tolerances) {
        trial.reach(tolerance);
        progress.done(method.name);
      }
      task.made = trial.take();
    } catch (const Error& error) {
      task.failure = error.what();
    }
  });
  for (std::size_t m = 0; m < options.methods.size(); ++m) {
    MethodResult made;
    made.method = options.methods[m];
    std::map<double, Encoding, std::greater<>> curve;
    for (Task& task : tasks) {
      if (task.method != m) continue;
      for (auto& [knob, encoding] : task.made) curve.emplace(knob, std::move(encoding));
      if (!task.failure.empty()) made.failure = task.failure;
    }
    for (auto& [knob, encoding] : curve) made.curve.push_back(std::move(encoding));
    choose_best(made, options.tolerances, source.size);
    result.methods.push_back(std::move(made));
  }
  return result;
}

}  // namespace nmc::baselines
