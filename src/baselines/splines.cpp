#include "baselines/splines.h"

#include <algorithm>
#include <cmath>

namespace nmc::baselines {
namespace {

/// Second derivatives at the keys (tridiagonal system, natural ends).
Eigen::MatrixXd second_derivatives(const std::vector<Eigen::Index>& keys, const Eigen::MatrixXd& values) {
  const auto count = static_cast<Eigen::Index>(keys.size());
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(values.rows(), count);
  if (count < 3) return m;
  std::vector<double> factor(keys.size(), 0.0);
  const auto gap = [&](Eigen::Index i) {
    return static_cast<double>(keys[static_cast<std::size_t>(i + 1)] - keys[static_cast<std::size_t>(i)]);
  };
  for (Eigen::Index i = 1; i + 1 < count; ++i) {
    const double before = gap(i - 1), after = gap(i);
    const double pivot = 2 * (before + after) - before * factor[static_cast<std::size_t>(i - 1)];
    factor[static_cast<std::size_t>(i)] = after / pivot;
    m.col(i) = (6 * ((values.col(i + 1) - values.col(i)) / after - (values.col(i) - values.col(i - 1)) / before) -
                before * m.col(i - 1)) /
               pivot;
  }
  for (Eigen::Index i = count - 2; i > 0; --i) m.col(i) -= factor[static_cast<std::size_t>(i)] * m.col(i + 1);
  return m;
}

double catmull_rom_at(const std::vector<Eigen::Index>& points, const Eigen::VectorXd& values, std::size_t i,
                      double sample) {
  const auto x = [&](std::size_t k) { return static_cast<double>(points[k]); };
  const auto y = [&](std::size_t k) { return values(static_cast<Eigen::Index>(k)); };
  const auto tangent = [&](std::size_t k) {
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, points.size() - 1);
    return (y(after) - y(before)) / (x(after) - x(before));
  };
  const double width = x(i + 1) - x(i), t = (sample - x(i)) / width;
  return (1 + 2 * t) * (1 - t) * (1 - t) * y(i) + t * (1 - t) * (1 - t) * width * tangent(i) +
         t * t * (3 - 2 * t) * y(i + 1) - t * t * (1 - t) * width * tangent(i + 1);
}

}  // namespace

Eigen::MatrixXd columns_at(const Eigen::MatrixXd& curve, const std::vector<Eigen::Index>& samples) {
  Eigen::MatrixXd columns(curve.rows(), static_cast<Eigen::Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = curve.col(samples[i]);
  return columns;
}

Eigen::MatrixXd cubic_spline(const std::vector<Eigen::Index>& keys, const Eigen::MatrixXd& values) {
  Eigen::MatrixXd curve(values.rows(), keys.back() + 1);
  curve.col(0) = values.col(0);
  const Eigen::MatrixXd m = second_derivatives(keys, values);
  for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const auto h = static_cast<double>(keys[k + 1] - keys[k]);
    for (Eigen::Index n = keys[k]; n <= keys[k + 1]; ++n) {
      const double b = static_cast<double>(n - keys[k]) / h, a = 1 - b;
      curve.col(n) = a * values.col(i) + b * values.col(i + 1) +
                     ((a * a * a - a) * m.col(i) + (b * b * b - b) * m.col(i + 1)) * (h * h / 6);
    }
  }
  return curve;
}

std::vector<Eigen::Index> choose_keys(const Eigen::MatrixXd& curve, double threshold) {
  const Eigen::Index last = curve.cols() - 1;
  std::vector<Eigen::Index> keys{0, last / 3, 2 * last / 3, last};
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  if (curve.rows() == 0) return keys;
  for (bool added = true; added;) {
    added = false;
    const Eigen::VectorXd errors = (cubic_spline(keys, columns_at(curve, keys)) - curve).colwise().norm();
    std::vector<Eigen::Index> next{0};
    for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
      if (keys[k + 1] - keys[k] > 1 && errors.segment(keys[k], keys[k + 1] - keys[k]).maxCoeff() > threshold) {
        next.push_back((keys[k] + keys[k + 1]) / 2);
        added = true;
      }
      next.push_back(keys[k + 1]);
    }
    keys = std::move(next);
  }
  return keys;
}

Eigen::VectorXd catmull_rom(const std::vector<Eigen::Index>& points, const Eigen::VectorXd& values) {
  Eigen::VectorXd curve(points.back() + 1);
  curve(0) = values(0);
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (Eigen::Index n = points[i]; n <= points[i + 1]; ++n)
      curve(n) = catmull_rom_at(points, values, i, static_cast<double>(n));
  return curve;
}

std::vector<Eigen::Index> regular_points(Eigen::Index frames, Eigen::Index span) {
  std::vector<Eigen::Index> points;
  for (Eigen::Index n = 0; n < frames; n += span) points.push_back(n);
  if (points.back() != frames - 1) points.push_back(frames - 1);
  return points;
}

std::vector<Eigen::Index> fit_catmull_rom(const Eigen::VectorXd& curve, Eigen::Index span, double threshold) {
  std::vector<Eigen::Index> points = regular_points(curve.size(), span);
  Eigen::VectorXd values = columns_at(curve.transpose(), points).transpose();
  Eigen::VectorXd errors = (catmull_rom(points, values) - curve).cwiseAbs();
  for (Eigen::Index worst = 0; errors.maxCoeff(&worst) > threshold;) {
    const auto place = std::lower_bound(points.begin(), points.end(), worst);
    if (place != points.end() && *place == worst) break;  // a point of the curve: nothing but rounding
    const auto index = static_cast<std::size_t>(place - points.begin());
    points.insert(place, worst);
    values = columns_at(curve.transpose(), points).transpose();
    // Two intervals to either side see other neighbours.
    for (std::size_t i = index < 3 ? 0 : index - 3; i < std::min(index + 3, points.size() - 1); ++i)
      for (Eigen::Index n = points[i]; n <= points[i + 1]; ++n)
        errors(n) = std::abs(catmull_rom_at(points, values, i, static_cast<double>(n)) - curve(n));
  }
  return points;
}

}  // namespace nmc::baselines
