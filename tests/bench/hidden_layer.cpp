#include "hidden_layer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "codec/features.h"
#include "network/fourier_features.h"
#include "network/frequency_search.h"
#include "network/pose_network.h"
#include "network/random.h"

namespace nmc::bench {
namespace {

using Matrix = Eigen::MatrixXf;

/// Numbers in whole steps under training, with the moments of Adam (Kingma and Ba 2015).
struct Tensor {
  Matrix level, gradient, first, second;
  float step = 1;

  void start(const Matrix& values, double step_size) {
    step = static_cast<float>(step_size);
    level = values / step;
    gradient = first = second = Matrix::Zero(values.rows(), values.cols());
  }

  Matrix values(bool rounded) const { return rounded ? Matrix(level.array().round() * step) : Matrix(level * step); }

  /// Against the gradient by the values and `rate` times the slope of log2(1 + 3 level^2).
  void descend(float speed, float rate, int iteration) {
    constexpr float beta1 = 0.9f, beta2 = 0.98f;
    gradient = gradient.array() * step + rate * 8.656170245f * level.array() / (1 + 3 * level.array().square());
    first = beta1 * first + (1 - beta1) * gradient;
    second = beta2 * second + (1 - beta2) * gradient.cwiseAbs2();
    const auto n = static_cast<float>(iteration + 1);
    const float c1 = 1 / (1 - std::pow(beta1, n)), c2 = 1 / (1 - std::pow(beta2, n));
    level.array() -= speed * (first.array() * c1) / ((second.array() * c2).sqrt() + 1e-12f);
  }

  /// As a stream has them: levels, then the step.
  std::vector<float> written() const {
    std::vector<float> numbers;
    for (Eigen::Index i = 0; i < level.size(); ++i) numbers.push_back(std::round(level.data()[i]));
    numbers.push_back(step);
    return numbers;
  }
};

/// What training knows of a clip. A column is a feature of a window, the only anchor, or the difference of two.
struct Seen {
  Matrix levels;         ///< outputs x columns: of the sparse layer
  Matrix columns;        ///< samples x columns: takes curves in slot steps to levels
  Eigen::VectorXf slot;  ///< per output: its step
  bool loops = false;
  std::vector<int> half_cycles;
  Matrix input;  ///< 2 K + 1 x samples
  Tensor w0, b0;
  Matrix first, second;  ///< activations of the last forward pass
};

class ClipColumns {
 public:
  ClipColumns(const SparseClip& from, double anchor_steps)
      : clip_(*from.clip), levels_(*from.levels), anchor_steps_(static_cast<float>(anchor_steps)) {
    output_of_.assign(clip_.layout.parameters.size(), -1);
    for (std::size_t i = 0; i < clip_.layout.moving.size(); ++i)
      output_of_[static_cast<std::size_t>(clip_.layout.moving[i])] = static_cast<Eigen::Index>(i);
  }

  void fill(Seen& seen) {
    seen.levels.resize(std::ssize(clip_.layout.moving), 0);
    seen.columns.resize(clip_.layout.values.cols(), 0);
    if (levels_.basis == codec::Basis::cosine) add_mean(seen);
    for (std::size_t w = 0; w < levels_.windows.size(); ++w) {
      add_features(levels_.windows[w], w + 1 == levels_.windows.size(), seen);
      if (levels_.basis != codec::Basis::cosine) add_anchors(w, seen);
    }
  }

 private:
  /// The first sample of the window and the first after it.
  static Eigen::Index begin(const codec::LevelWindow& window) { return static_cast<Eigen::Index>(window.begin); }
  static Eigen::Index end(const codec::LevelWindow& window) {
    return static_cast<Eigen::Index>(window.begin) + static_cast<Eigen::Index>(window.length);
  }

  static auto append(Matrix& to, Eigen::Index count) {
    to.conservativeResize(Eigen::NoChange, to.cols() + count);
    to.rightCols(count).setZero();
    return to.rightCols(count);
  }

  /// Those in use, and some above them that the network would have to leave alone.
  void add_features(const codec::LevelWindow& window, bool last, Seen& seen) {
    int most = 0;
    for (const codec::LevelWeight& weight : window.weights) most = std::max(most, weight.feature);
    if (most == 0) return;
    const auto length = static_cast<Eigen::Index>(window.length);
    const Eigen::Index count = std::max<Eigen::Index>(most, std::min<Eigen::Index>(most + most / 4 + 2, length - 2));
    const bool anchored = levels_.basis != codec::Basis::cosine;
    const Eigen::Index samples = last ? clip_.layout.values.cols() - begin(window) : length;
    Matrix features = codec::window_features(levels_.basis, window.length, count, samples).cast<float>();
    if (anchored && samples > length) features.col(length).setZero();
    features *= static_cast<float>(
        2 / (static_cast<double>(window.length) * codec::weight_scale(levels_.step_exponent, window.length)));
    auto columns = append(seen.columns, count);
    columns.middleRows(begin(window), samples) = features.transpose();
    if (anchored) {
      const Matrix shares = codec::anchor_shares(levels_.basis, window.length, samples).cast<float>();
      columns.row(begin(window)) -= shares.row(0) * features.transpose();
      columns.row(end(window)) -= shares.row(1) * features.transpose();
    }
    auto levels = append(seen.levels, count);
    for (const codec::LevelWeight& weight : window.weights)
      levels(output_of_[static_cast<std::size_t>(weight.parameter)], weight.feature - 1) =
          static_cast<float>(weight.level);
  }

  void add_mean(Seen& seen) {
    append(seen.columns, 1).setConstant(anchor_steps_ / static_cast<float>(clip_.layout.values.cols()));
    auto levels = append(seen.levels, 1);
    for (std::size_t p = 0; p < output_of_.size(); ++p)
      if (output_of_[p] >= 0) levels(output_of_[p], 0) = static_cast<float>(levels_.anchors[p]);
  }

  void add_anchors(std::size_t w, Seen& seen) {
    auto column = append(seen.columns, 1);
    column(begin(levels_.windows[w]), 0) = -anchor_steps_;
    column(end(levels_.windows[w]), 0) = anchor_steps_;
    auto levels = append(seen.levels, 1);
    const std::size_t parameters = output_of_.size();
    for (std::size_t p = 0; p < parameters; ++p)
      if (output_of_[p] >= 0)
        levels(output_of_[p], 0) =
            static_cast<float>(levels_.anchors[(w + 1) * parameters + p] - levels_.anchors[w * parameters + p]);
  }

  const codec::PreparedClip& clip_;
  const codec::LevelClip& levels_;
  float anchor_steps_;
  std::vector<Eigen::Index> output_of_;  ///< per parameter; -1 where it does not move
};

bool is_loop(const SparseClip& clip) {
  const std::size_t parameters = clip.clip->layout.parameters.size();
  const std::vector<std::int32_t>& anchors = clip.levels->anchors;
  return anchors.size() > parameters &&
         std::equal(anchors.begin(), anchors.begin() + static_cast<std::ptrdiff_t>(parameters),
                    anchors.end() - static_cast<std::ptrdiff_t>(parameters));
}

/// The strongest in the main movement of a clip (Tojo et al. 2022, lines 8 and 9 of Algorithm 1), of the whole cycles
/// in a loop.
std::vector<int> strongest_half_cycles(const SparseClip& clip, const Eigen::VectorXf& slot, int count, bool loops) {
  Matrix poses(clip.clip->layout.values.cols(), slot.size());
  for (Eigen::Index i = 0; i < slot.size(); ++i)
    poses.col(i) = clip.clip->layout.values.row(clip.clip->layout.moving[static_cast<std::size_t>(i)]).cast<float>();
  std::vector<int> taken, chosen;
  while (std::ssize(chosen) < count) {
    const int next = network::dominant_half_cycles(poses, slot.cwiseInverse(), taken);
    if (next == 0) break;
    taken.push_back(next);
    if (!loops || next % 2 == 0) chosen.push_back(next);
  }
  return chosen;
}

class HiddenTrainer {
 public:
  HiddenTrainer(const std::vector<SparseClip>& clips, const codec::ClipSet& set, const HiddenSettings& settings)
      : clips_(clips), settings_(settings), random_(1) {
    for (const SparseClip& clip : clips) clips_seen_.push_back(see(clip, set));
    w1_.start(random(settings.hidden1, settings.hidden0, 1.5 / std::sqrt(settings.hidden0)), settings.hidden_step);
    b1_.start(random(settings.hidden1, 1, 0.5), settings.hidden_step);
    start_outputs();
  }

  HiddenLayer run() {
    const float widest = 2 * usual_level();
    for (int it = 0; it < settings_.iterations; ++it) {
      const float done = static_cast<float>(it) / static_cast<float>(settings_.iterations);
      // At first what is large counts, as in a sum of squares; at last what costs bits.
      learn(std::max(1.0f, widest * std::pow(widest, -done / 0.6f)), done > 0.5f);
      descend(0.5f * (1 + std::cos(3.14159265f * done)), done > 0.5f ? static_cast<float>(settings_.rate) : 0.0f, it);
    }
    return result();
  }

 private:
  Matrix random(Eigen::Index rows, Eigen::Index columns, double range) {
    Matrix made(rows, columns);
    for (float& value : made.reshaped()) value = static_cast<float>(range * random_.uniform());
    return made;
  }

  Seen see(const SparseClip& from, const codec::ClipSet& set) {
    Seen seen;
    const codec::ClipLayout& layout = from.clip->layout;
    seen.slot.resize(std::ssize(layout.moving));
    for (Eigen::Index i = 0; i < seen.slot.size(); ++i)
      seen.slot(i) = static_cast<float>(from.clip->steps.slot(layout.moving[static_cast<std::size_t>(i)]));
    ClipColumns(from, std::exp2(set.anchor_exponent / 4.0)).fill(seen);
    seen.loops = is_loop(from);
    seen.half_cycles = strongest_half_cycles(from, seen.slot, settings_.frequencies, seen.loops);
    seen.input = network::fourier_features(seen.half_cycles, network::frame_times(layout.values.cols())).transpose();
    Matrix w0 = random(settings_.hidden0, seen.input.rows(), 1.2 / std::sqrt(static_cast<double>(seen.input.rows())));
    if (seen.loops) w0.col(0).setZero();
    seen.w0.start(w0, settings_.hidden_step);
    seen.b0.start(random(settings_.hidden0, 1, 0.5), settings_.hidden_step);
    return seen;
  }

  /// W2 by least squares on the random layers below it.
  void start_outputs() {
    const Eigen::VectorXf& slot = clips_seen_.front().slot;
    Matrix square = Matrix::Zero(settings_.hidden1, settings_.hidden1),
           right = Matrix::Zero(slot.size(), square.rows());
    for (Seen& seen : clips_seen_) {
      const Matrix inner = forward(seen, false);
      square += inner * inner.transpose();
      right += slot.asDiagonal() * seen.levels * inner.transpose();
    }
    square.diagonal().array() += 0.02f * square.trace() / static_cast<float>(settings_.hidden1) + 1e-3f;
    Eigen::VectorXf sorted = slot;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    w2_.start(square.ldlt().solve(right.transpose()).transpose(),
              settings_.output_step * static_cast<double>(sorted(sorted.size() / 2)));
  }

  /// What W2 works on, in the columns' terms.
  Matrix forward(Seen& seen, bool rounded) {
    seen.first = seen.w0.values(rounded) * seen.input;
    seen.first.colwise() += seen.b0.values(rounded).col(0);
    seen.first = network::elu(seen.first.array()).matrix().eval();
    seen.second = w1_.values(rounded) * seen.first;
    seen.second.colwise() += b1_.values(rounded).col(0);
    seen.second = network::elu(seen.second.array()).matrix().eval();
    return seen.second * seen.columns;
  }

  /// The root mean square of the levels that are not zero.
  float usual_level() const {
    double sum = 0, count = 1;
    for (const Seen& seen : clips_seen_) {
      sum += static_cast<double>(seen.levels.squaredNorm());
      count += static_cast<double>((seen.levels.array() != 0).count());
    }
    return std::max(1.0f, static_cast<float>(std::sqrt(sum / count)));
  }

  /// The gradients of the sum of log2(1 + 3 (level / width)^2) over the levels that are left.
  void learn(float width, bool rounded) {
    for (Tensor* tensor : {&w1_, &b1_, &w2_}) tensor->gradient.setZero();
    for (Seen& seen : clips_seen_) {
      const Matrix inner = forward(seen, rounded);
      const Eigen::VectorXf unit = seen.slot.cwiseInverse();
      const Matrix outputs = unit.asDiagonal() * w2_.values(rounded);
      const Eigen::ArrayXXf left = (seen.levels - outputs * inner).array() / width;
      const Matrix slope = (-8.656170245f / width * left / (1 + 3 * left.square())).matrix();
      w2_.gradient += unit.asDiagonal() * (slope * inner.transpose());
      const Matrix second = (outputs.transpose() * slope * seen.columns.transpose()).array() *
                            network::elu_derivative(seen.second.array());
      w1_.gradient += second * seen.first.transpose();
      b1_.gradient += second.rowwise().sum();
      const Matrix first =
          (w1_.values(rounded).transpose() * second).array() * network::elu_derivative(seen.first.array());
      seen.w0.gradient = first * seen.input.transpose();
      if (seen.loops) seen.w0.gradient.col(0).setZero();
      seen.b0.gradient = first.rowwise().sum();
    }
  }

  void descend(float speed, float rate, int iteration) {
    const float size = w2_.level.norm() / std::sqrt(static_cast<float>(w2_.level.size()));
    w2_.descend(speed * (0.1f + 0.01f * size), rate, iteration);
    for (Tensor* tensor : {&w1_, &b1_}) tensor->descend(0.15f * speed, rate, iteration);
    for (Seen& seen : clips_seen_)
      for (Tensor* tensor : {&seen.w0, &seen.b0}) tensor->descend(0.15f * speed, rate, iteration);
  }

  HiddenLayer result() {
    HiddenLayer made;
    const Eigen::Index outputs = w2_.level.rows();
    Tensor none;  // anchors have what b2 could say
    none.start(Matrix::Zero(outputs, 1), 1);
    made.shared = {settings_.hidden0, settings_.hidden1, static_cast<int>(outputs), w1_.written(), b1_.written(),
                   w2_.written(),     none.written()};
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      Seen& seen = clips_seen_[c];
      forward(seen, true);
      made.clips.push_back({seen.half_cycles, seen.w0.written(), seen.b0.written()});
      const codec::ClipLayout& layout = clips_[c].clip->layout;
      const Matrix values = w2_.values(true) * seen.second;
      made.given.push_back(Eigen::MatrixXd::Zero(layout.values.rows(), layout.values.cols()));
      for (Eigen::Index i = 0; i < outputs; ++i)
        made.given.back().row(layout.moving[static_cast<std::size_t>(i)]) = values.row(i).cast<double>();
    }
    return made;
  }

  const std::vector<SparseClip>& clips_;
  const HiddenSettings& settings_;
  network::Random random_;
  std::vector<Seen> clips_seen_;
  Tensor w1_, b1_, w2_;
};

}  // namespace

HiddenLayer train_hidden_layer(const std::vector<SparseClip>& clips, const codec::ClipSet& set,
                               const HiddenSettings& settings) {
  return HiddenTrainer(clips, set, settings).run();
}

}  // namespace nmc::bench
