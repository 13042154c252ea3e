#include "codec/sparse_training.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "codec/atoms.h"
#include "codec/features.h"

namespace nmc::codec {
namespace {

using Matrix = Eigen::MatrixXf;
/// Parameters x samples, laid out as the errors are.
using Curves = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct AdamStep {
  float speed = 0, first_correction = 1, second_correction = 1;
};

/// Numbers under training with the moments of Adam (Kingma and Ba 2015).
struct Trained {
  Weights level, gradient, first, second;

  void start(Weights levels) {
    level = std::move(levels);
    gradient = first = second = Weights::Zero(level.rows(), level.cols());
  }

  /// Keeps the first columns.
  void shorten(Eigen::Index columns) {
    for (Weights* part : {&level, &gradient, &first, &second}) *part = part->leftCols(columns).eval();
  }

  /// One step of the first numbers of a row.
  void step(Eigen::Index row, Eigen::Index count, const AdamStep& step) {
    constexpr float beta1 = 0.9f, beta2 = 0.99f;
    const auto slope = gradient.row(row).head(count).array();
    auto mean = first.row(row).head(count).array(), square = second.row(row).head(count).array();
    mean = beta1 * mean + (1 - beta1) * slope;
    square = beta2 * square + (1 - beta2) * slope.square();
    level.row(row).head(count).array() -=
        step.speed * (mean * step.first_correction) / ((square * step.second_correction).sqrt() + 1e-8f);
  }
};

struct Window {
  Eigen::Index first = 0, samples = 0;  ///< owned samples
  std::uint32_t length = 1;
  std::vector<Curves> features;     ///< per turn: count x its samples
  Matrix shares;                    ///< 2 x samples
  Eigen::VectorXf step;             ///< per parameter
  Weights price;                    ///< parameters x count: of a bit of the smooth rate
  std::vector<Eigen::Index> reach;  ///< per parameter: features that it uses and a few more, which most steps are of
  Trained weights;                  ///< parameters x count
};

/// Every so-manieth sample of a clip: what one iteration looks at.
struct Turn {
  Eigen::Index first = 0;  ///< sample of the clip; the others follow `stride` apart
  MotionMap map;
  Focus focus;
  Rows rest;  ///< what the anchors alone leave: parameters x samples
};

/// The samples of a window that a turn has, as a turn's columns.
struct Columns {
  Eigen::Index first = 0, count = 0;
};

Matrix rounded(const Matrix& levels) { return levels.array().round().matrix(); }

/// d log2(1 + 3 u^2) / du: the slope of a smooth stand-in for a level's bits.
template <typename Derived>
auto rate_slope(const Eigen::ArrayBase<Derived>& u) {
  return 8.656170245f * u / (1.0f + 3.0f * u.square());
}

class Trainer {
 public:
  Trainer(const TrainingInput& input, MotionMap& map, const SparseSettings& settings)
      : input_(input),
        layout_(*input.layout),
        steps_(*input.steps),
        map_(map),
        stride_(static_cast<Eigen::Index>(input.offset.size())),
        settings_(settings),
        parameters_(static_cast<Eigen::Index>(input.layout->moving.size())),
        samples_(input.layout->values.cols()) {
    truth_.resize(parameters_, samples_);
    anchor_step_.resize(parameters_);
    slot_step_.resize(parameters_);
    end_sign_.resize(parameters_);
    shell_reach_.resize(parameters_);
    const Eigen::VectorXd signs = end_signs(layout_);
    for (Eigen::Index i = 0; i < parameters_; ++i) {
      truth_.row(i) = layout_.values.row(parameter(i)).cast<float>();
      anchor_step_(i) = static_cast<float>(steps_.anchor(parameter(i)));
      slot_step_(i) = static_cast<float>(steps_.slot(parameter(i)));
      end_sign_(i) = static_cast<float>(signs(parameter(i)));
      shell_reach_(i) = static_cast<float>(shell_share * input.tolerance) / slot_step_(i);
    }
    for (const LayoutBlock& block : layout_.blocks)
      if (block.state == State::quaternion)
        shell_reach_.segment(block.first_moving, block.block.width)
            .setConstant(static_cast<float>(input.tolerance / quaternion_error));
    take_given_out();
    start_anchors();
    start_windows();
  }

  TrainedClip run() {
    if (settings_.iterations > 0 && parameters_ > 0 && input_.parts.quantisation_aware) train();
    return {result(), state()};
  }

 private:
  Eigen::Index parameter(Eigen::Index i) const { return layout_.moving[static_cast<std::size_t>(i)]; }

  bool has_atoms() const { return settings_.jumps && input_.atoms; }

  /// What atoms and a network already give is not to be learned.
  void take_given_out() {
    given_ = steps_.given;
    if (has_atoms()) add_atoms();
    if (given_.size() == 0) return;
    for (Eigen::Index i = 0; i < parameters_; ++i) truth_.row(i) -= given_.row(parameter(i)).cast<float>();
  }

  void add_atoms() {
    LevelClip windows;
    windows.basis = settings_.basis;
    for (std::size_t w = 0; w + 1 < settings_.boundaries.size(); ++w)
      windows.windows.push_back({settings_.boundaries[w], settings_.boundaries[w + 1] - settings_.boundaries[w], {}});
    if (given_.size() == 0) given_ = Eigen::MatrixXd::Zero(layout_.values.rows(), samples_);
    for (const LevelAtom& atom : *input_.atoms) add_atom_values(atom, windows, steps_, given_);
  }

  bool single_anchor() const { return settings_.basis == Basis::cosine; }

  /// The poses of the motion itself: trained ones cost more bytes than they save.
  void start_anchors() {
    const std::size_t rows = single_anchor() ? 1 : settings_.boundaries.size();
    anchors_.resize(parameters_, static_cast<Eigen::Index>(rows));
    for (std::size_t r = 0; r < rows; ++r) {
      const auto column = static_cast<Eigen::Index>(r);
      if (single_anchor())
        anchors_.col(column) = truth_.rowwise().mean();
      else if (settings_.basis == Basis::periodic)
        anchors_.col(column) = periodic_anchor(column);
      else
        anchors_.col(column) = truth_.col(std::min(static_cast<Eigen::Index>(settings_.boundaries[r]), samples_ - 1));
    }
    anchors_ = rounded(anchor_step_.cwiseInverse().asDiagonal() * anchors_);
    if (settings_.loops) anchors_.rightCols(1) = end_sign_.cwiseProduct(anchors_.leftCols(1)) + closing_levels();
  }

  /// How far the last pose of a loop is from the first: nothing, mostly.
  Eigen::VectorXf closing_levels() const {
    const Eigen::VectorXf gap = truth_.rightCols(1) - end_sign_.cwiseProduct(truth_.leftCols(1));
    return (gap.array() / anchor_step_.array()).round().matrix();
  }

  /// The whole cycles have no mean of their own: the line between the two anchors carries it, and the drift.
  Eigen::VectorXf periodic_anchor(Eigen::Index column) const {
    const Eigen::VectorXf drift = truth_.col(samples_ - 1) - truth_.col(0);
    Eigen::VectorXf mean = truth_.leftCols(samples_ - 1).rowwise().mean();
    mean += drift * (0.5f / static_cast<float>(samples_ - 1));
    return mean + drift * (static_cast<float>(column) - 0.5f);
  }

  void start_windows() {
    for (std::size_t w = 0; w + 1 < settings_.boundaries.size(); ++w) {
      Window window;
      window.first = static_cast<Eigen::Index>(settings_.boundaries[w]);
      window.length = settings_.boundaries[w + 1] - settings_.boundaries[w];
      const bool last = w + 2 == settings_.boundaries.size();
      window.samples = last ? samples_ - window.first : static_cast<Eigen::Index>(window.length);
      window.shares = anchor_shares(settings_.basis, window.length, window.samples).cast<float>();
      const double scale = weight_scale(settings_.step_exponent, window.length);
      window.step = slot_step_ * static_cast<float>(scale);
      start_weights(window, w);
      windows_.push_back(std::move(window));
    }
  }

  /// The transform of what the anchors leave, in levels: parameters x features, up to the last feature that could
  /// matter at these steps.
  Weights transform(const Window& window, std::size_t w) const {
    const Eigen::Index limit = feature_limit(settings_.basis, window.length);
    const Matrix all = window_features(settings_.basis, window.length, limit, window.samples).cast<float>();
    Matrix rest = truth_.middleCols(window.first, window.samples) - anchor_values(window, w);
    const auto after = static_cast<Eigen::Index>(window.length);
    if (settings_.basis != Basis::cosine && window.samples > after) rest.col(after).setZero();
    Matrix levels = rest * all.transpose() * (2.0f / static_cast<float>(window.length));
    if (settings_.basis == Basis::periodic && window.length % 2 == 0 && limit >= 1)
      levels.col(limit - 1) *= 0.5f;  // the cosine at half the rate
    levels.array().colwise() /= window.step.array();
    Eigen::Index count = parameters_ > 0 ? limit : 0;
    while (count > 0 && levels.col(count - 1).cwiseAbs().maxCoeff() < 0.5f) --count;
    return levels.leftCols(count);
  }

  void start_weights(Window& window, std::size_t w) {
    Weights levels = transform(window, w);
    if (input_.start) levels = continued_levels(input_.start->weights[w], levels.cols());
    window.weights.start(std::move(levels));
  }

  /// Levels of an earlier training at these steps; features that it did not have are zero.
  Weights continued_levels(const Weights& earlier, Eigen::Index least) const {
    Weights levels = Weights::Zero(parameters_, std::max(least, earlier.cols()));
    const double finer = std::exp2((settings_.step_exponent - input_.start->step_exponent) / 4.0);
    levels.leftCols(earlier.cols()) = earlier * static_cast<float>(finer);
    return levels;
  }

  TrainingState state() const {
    TrainingState state{settings_.step_exponent, {}};
    for (const Window& window : windows_) state.weights.push_back(window.weights.level);
    return state;
  }

  Matrix anchor_values(const Window& window, std::size_t w) const {
    const auto first = static_cast<Eigen::Index>(single_anchor() ? 0 : w);
    const auto second = single_anchor() ? 0 : first + 1;
    Matrix ends(parameters_, 2);
    ends.col(0) = anchors_.col(first).cwiseProduct(anchor_step_);
    ends.col(1) = anchors_.col(second).cwiseProduct(anchor_step_);
    return ends * window.shares;
  }

  /// The samples first, first + stride, ... below `end` of the clip that a turn has.
  Columns columns_of(const Turn& turn, Eigen::Index first, Eigen::Index end) const {
    const auto before = [&](Eigen::Index sample) { return (sample - turn.first + stride_ - 1) / stride_; };
    return {before(first), before(end) - before(first)};
  }

  template <typename Body>
  void for_windows(const Body& body) {
    parallel_for(windows_.size(), input_.threads, [&](std::size_t w) { body(windows_[w], w); });
  }

  void start_turns() {
    map_.forget();
    for (Eigen::Index first = 0; first < stride_; ++first) {
      Turn turn{first, map_, {}, {}};
      turn.rest.resize(parameters_, columns_of(turn, 0, samples_).count);
      turns_.push_back(std::move(turn));
    }
    for_windows([&](Window& window, std::size_t w) {
      const Eigen::Index count = window.weights.level.cols();
      const Matrix features = window_features(settings_.basis, window.length, count, window.samples).cast<float>();
      const Matrix rest = anchor_values(window, w) - truth_.middleCols(window.first, window.samples);
      for (Turn& turn : turns_) {
        const Columns columns = columns_of(turn, window.first, window.first + window.samples);
        const auto own = Eigen::seqN(turn.first + columns.first * stride_ - window.first, columns.count, stride_);
        window.features.push_back(features(Eigen::all, own));
        turn.rest.middleCols(columns.first, columns.count) = rest(Eigen::all, own).array();
      }
    });
    truth_.resize(0, 0);
  }

  /// What the levels stand for, without the truth.
  void forward(std::size_t t) {
    const Turn& turn = turns_[t];
    delta_ = turn.rest;
    for_windows([&](const Window& window, std::size_t) {
      const Columns columns = columns_of(turn, window.first, window.first + window.samples);
      if (is_wide(columns)) {
        add_used(window, t, columns);
      } else if (window.features[t].size() > 0) {
        delta_.matrix().middleCols(columns.first, columns.count).noalias() +=
            window.step.asDiagonal() * rounded(window.weights.level) * window.features[t];
      }
    });
  }

  /// Where most levels are zero, and skipping them one by one is faster than a product of matrices.
  static bool is_wide(const Columns& columns) { return columns.count >= 128; }

  void add_used(const Window& window, std::size_t t, const Columns& columns) {
    for (Eigen::Index i = 0; i < parameters_; ++i) {
      auto row = delta_.row(i).segment(columns.first, columns.count);
      for (Eigen::Index j = 0; j < window.weights.level.cols(); ++j) {
        const float level = window.weights.level(i, j);
        if (std::abs(level) >= 0.5f) row += window.step(i) * std::round(level) * window.features[t].row(j).array();
      }
    }
  }

  /// One step of the weights; in wide windows most often of those within reach alone.
  void backward(std::size_t t, float rate_weight, const AdamStep& step, bool all_of_wide) {
    const Turn& turn = turns_[t];
    for_windows([&](Window& window, std::size_t) {
      const Curves& features = window.features[t];
      if (features.rows() == 0) return;
      const Columns columns = columns_of(turn, window.first, window.first + window.samples);
      const auto part = gradient_.matrix().middleCols(columns.first, columns.count);
      Trained& weights = window.weights;
      const bool all = all_of_wide || !is_wide(columns);
      if (all) weights.gradient.noalias() = part * features.transpose();
      for (Eigen::Index i = 0; i < parameters_; ++i) {
        const Eigen::Index count = all ? features.rows() : window.reach[static_cast<std::size_t>(i)];
        auto slope = weights.gradient.row(i).head(count);
        if (!all) slope.noalias() = part.row(i) * features.topRows(count).transpose();
        slope *= window.step(i);
        slope.array() += rate_weight * window.price.row(i).head(count).array() *
                         rate_slope(weights.level.row(i).head(count).array());
        weights.step(i, count, step);
      }
      if (all && is_wide(columns)) find_reach(window);
    });
  }

  /// Features up to the last one with a level that does not round to zero.
  template <typename Levels>
  static Eigen::Index used_features(const Eigen::MatrixBase<Levels>& levels) {
    Eigen::Index used = levels.cols();
    while (used > 0 && levels.col(used - 1).cwiseAbs().maxCoeff() < 0.5f) --used;
    return used;
  }

  void find_reach(Window& window) const {
    const Weights& levels = window.weights.level;
    window.reach.resize(static_cast<std::size_t>(parameters_));
    for (Eigen::Index i = 0; i < parameters_; ++i) {
      const Eigen::Index used = used_features(levels.row(i));
      window.reach[static_cast<std::size_t>(i)] = std::min(levels.cols(), used + used / 4 + 8);
    }
  }

  /// Halfway between the motion and what the levels stand for.
  void linearise(std::size_t t) {
    forward(t);
    Turn& turn = turns_[t];
    Eigen::MatrixXd middle = layout_.values(Eigen::all, Eigen::seqN(turn.first, delta_.cols(), stride_));
    for (Eigen::Index i = 0; i < parameters_; ++i)
      middle.row(parameter(i)) += 0.5 * delta_.row(i).matrix().cast<double>();
    turn.map.linearise(middle, input_.threads);
  }

  /// The norm rises while a training goes on; one that continues another starts with the middle one.
  static int norm_of(double progress) { return progress < 0.2 ? 2 : progress < 0.45 ? 4 : 6; }

  void train() {
    constexpr int refresh = 50, refocus = 10;
    static_assert(refresh % refocus == 0, "features that are dropped have no price");
    start_turns();
    for (int it = 0; it < settings_.iterations; ++it) {
      const double done = static_cast<double>(it) / settings_.iterations;
      const double progress = input_.start ? continued + (1 - continued) * done : done;
      const std::size_t t = static_cast<std::size_t>(it) % turns_.size();
      const int round = it / static_cast<int>(turns_.size());
      if (it % refresh == 0) {
        for (std::size_t each = 0; each < turns_.size(); ++each) linearise(each);
        if (it > 0) drop_unused_features();
      }
      if (it % refocus == 0) price_levels();
      forward(t);
      Turn& turn = turns_[t];
      if (round % refocus == 0) turn.focus = turn.map.focus(delta_, input_.offset[t], input_.tolerance, input_.threads);
      const PointLoss loss{input_.tolerance, input_.parts.rising_norm ? norm_of(progress) : 2,
                           input_.emphasis.empty() ? nullptr : &input_.emphasis[t]};
      const double mean_weight = input_.parts.kinematics ? turn.map.descend(delta_, input_.offset[t], loss, &turn.focus,
                                                                            input_.threads, gradient_)
                                                         : descend_parameters();
      const double step = std::exp2(-settings_.step_exponent / 2.0);
      // The slope of distortion over rate of a uniform quantiser, 2 ln 2 step^2 / 12, times the caller's factor.
      const auto rate_weight =
          static_cast<float>(settings_.rate * 0.1155 * step * mean_weight / static_cast<double>(stride_));
      if (!(gradient_.abs().maxCoeff() < senseless)) return;
      add_shell();
      const auto speed = static_cast<float>(0.15 * 0.5 * (1 + std::cos(3.14159265358979 * progress)));
      backward(t, rate_weight,
               {speed, static_cast<float>(1 / (1 - std::pow(0.9, it + 1))),
                static_cast<float>(1 / (1 - std::pow(0.99, it + 1)))},
               it % refocus < static_cast<int>(turns_.size()));
    }
  }

  void price_levels() {
    std::vector<Weights> levels;
    for (const Window& window : windows_) levels.push_back(window.weights.level);
    std::vector<Weights> prices = level_prices(levels, layout_);
    for (std::size_t w = 0; w < windows_.size(); ++w) windows_[w].price = std::move(prices[w]);
  }

  /// The fastest features hardly ever come back once no parameter uses them.
  void drop_unused_features() {
    for (Window& window : windows_) {
      const Eigen::Index count = used_features(window.weights.level);
      window.weights.shorten(count);
      for (Curves& features : window.features) features = features.topRows(count).eval();
    }
  }

  /// The gradient of the parameters' own squared errors, each as if it moved one point; as MotionMap::descend.
  double descend_parameters() {
    gradient_ = delta_;
    for (Eigen::Index i = 0; i < parameters_; ++i) gradient_.row(i) *= 2 / (slot_step_(i) * slot_step_(i));
    return static_cast<double>(parameters_);
  }

  /// A twist that moves no point still has a small cost, as if each parameter moved a point of its own a little; so has
  /// the length of a quaternion, or bits could be saved by shrinking it until rounding turns it anywhere.
  void add_shell() {
    const auto unit = static_cast<float>(2.0 / (input_.tolerance * input_.tolerance));
    for (Eigen::Index i = 0; i < parameters_; ++i)
      gradient_.row(i) += unit * shell_reach_(i) * shell_reach_(i) * delta_.row(i);
  }

  LevelClip result() const {
    LevelClip clip;
    clip.basis = settings_.basis;
    clip.step_exponent = settings_.step_exponent;
    const auto all = layout_.values.rows();
    clip.anchors.resize(static_cast<std::size_t>(all * anchors_.cols()));
    for (Eigen::Index r = 0; r < anchors_.cols(); ++r) {
      std::int32_t* row = clip.anchors.data() + r * all;
      for (Eigen::Index i = 0; i < all; ++i)
        if (!layout_.parameters[static_cast<std::size_t>(i)].moves) row[i] = fixed_level(layout_, steps_, i);
      for (Eigen::Index i = 0; i < parameters_; ++i) row[parameter(i)] = static_cast<std::int32_t>(anchors_(i, r));
    }
    for (const Window& window : windows_) {
      LevelWindow made{static_cast<std::uint32_t>(window.first), window.length, {}};
      for (Eigen::Index i = 0; i < parameters_; ++i)
        for (Eigen::Index j = 0; j < window.weights.level.cols(); ++j)
          if (const long level = std::lround(window.weights.level(i, j)); level != 0)
            made.weights.push_back(
                {static_cast<int>(j) + 1, static_cast<int>(parameter(i)), static_cast<std::int32_t>(level)});
      clip.windows.push_back(std::move(made));
    }
    if (has_atoms()) clip.atoms = *input_.atoms;
    return clip;
  }

  /// Gradients of poses that the linear map knows nothing about; what has been learned until then stands.
  static constexpr float senseless = 1e15f;

  static constexpr double shell_share = 0.05, quaternion_error = 0.05;

  static constexpr double continued = 0.35;

  const TrainingInput& input_;
  const ClipLayout& layout_;
  const ParameterSteps& steps_;
  MotionMap& map_;
  Eigen::Index stride_;  ///< number of turns
  const SparseSettings& settings_;
  Eigen::Index parameters_, samples_;
  Eigen::VectorXf anchor_step_, slot_step_;
  Eigen::VectorXf end_sign_;     ///< of a loop (end_signs)
  Eigen::VectorXf shell_reach_;  ///< how far the point of its own moves, world units a unit of the parameter
  Eigen::MatrixXd given_;        ///< by atoms and a network: all parameters x samples; empty where there are none
  Curves truth_;                 ///< without what is given; until the turns have it
  Matrix anchors_;               ///< in whole steps: parameters x anchor rows
  std::vector<Window> windows_;
  std::vector<Turn> turns_;
  Rows delta_, gradient_;  ///< of the turn that is looked at: parameters x samples
};

}  // namespace

std::vector<LaneRows> in_turns(const Rows& rows, Eigen::Index turns) {
  std::vector<LaneRows> parts;
  for (Eigen::Index first = 0; first < turns; ++first)
    parts.push_back(in_blocks(rows(Eigen::all, Eigen::seq(first, Eigen::last, turns))));
  return parts;
}

TrainedClip train_sparse(const TrainingInput& input, MotionMap& map, const SparseSettings& settings) {
  return Trainer(input, map, settings).run();
}

std::int32_t fixed_level(const ClipLayout& layout, const ParameterSteps& steps, Eigen::Index parameter) {
  return static_cast<std::int32_t>(std::lround(layout.values(parameter, 0) / steps.anchor(parameter)));
}

namespace {

/// What anchors and weights of a window mean at its first samples: samples x all parameters.
Eigen::MatrixXd window_values(const LevelClip& clip, const ParameterSteps& steps, std::size_t w, Eigen::Index samples) {
  constexpr double worth_a_product = 1e8;  // in windows of thousands of samples most weights are not zero
  const LevelWindow& window = clip.windows[w];
  const Eigen::Index parameters = steps.slot.size();
  const std::size_t row = clip.basis == Basis::cosine ? 0 : w;
  const std::size_t next = clip.basis == Basis::cosine ? 0 : w + 1;
  Eigen::MatrixXd ends(2, parameters);
  for (Eigen::Index i = 0; i < parameters; ++i) {
    const auto p = static_cast<std::size_t>(parameters), k = static_cast<std::size_t>(i);
    ends(0, i) = clip.anchors[row * p + k] * steps.anchor(i);
    ends(1, i) = clip.anchors[next * p + k] * steps.anchor(i);
  }
  Eigen::MatrixXd values = anchor_shares(clip.basis, window.length, samples).transpose() * ends;
  int most = 0;
  for (const LevelWeight& weight : window.weights) most = std::max(most, weight.feature);
  if (most == 0) return values;
  const Eigen::MatrixXd features = window_features(clip.basis, window.length, most, samples).transpose();
  const double scale = weight_scale(clip.step_exponent, window.length);
  if (static_cast<double>(parameters) * most * static_cast<double>(samples) > worth_a_product) {
    Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(most, parameters);
    for (const LevelWeight& weight : window.weights)
      weights(weight.feature - 1, weight.parameter) = weight.level * steps.slot(weight.parameter) * scale;
    values.noalias() += features * weights;
    return values;
  }
  for (const LevelWeight& weight : window.weights)
    values.col(weight.parameter) +=
        weight.level * steps.slot(weight.parameter) * scale * features.col(weight.feature - 1);
  return values;
}

}  // namespace

Eigen::MatrixXd values_of_levels(const LevelClip& clip, const ParameterSteps& steps, Eigen::Index samples,
                                 int threads) {
  Eigen::MatrixXd values(steps.slot.size(), samples);
  parallel_for(clip.windows.size(), threads, [&](std::size_t w) {
    const LevelWindow& window = clip.windows[w];
    const auto first = static_cast<Eigen::Index>(window.begin);
    const Eigen::Index count =
        w + 1 == clip.windows.size() ? samples - first : static_cast<Eigen::Index>(window.length);
    values.middleCols(first, count) = window_values(clip, steps, w, count).transpose();
  });
  for (const LevelAtom& atom : clip.atoms) add_atom_values(atom, clip, steps, values);
  if (steps.given.size() > 0) values += steps.given;
  return values;
}

}  // namespace nmc::codec
