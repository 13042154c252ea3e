#include "network/frequency_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace nmc::network;

double cosine(int k, Eigen::Index n, Eigen::Index count) {
  return std::cos(std::numbers::pi * k * (static_cast<double>(n) + 0.5) / static_cast<double>(count));
}

TEST(Dct, OfAPureCosineIsItsIndexAlone) {
  const Eigen::Index count = 37;
  for (const int k : {0, 1, 5, 36}) {
    Eigen::VectorXd signal(count);
    for (Eigen::Index n = 0; n < count; ++n) signal[n] = cosine(k, n, count);
    const Eigen::VectorXd coefficients = dct(signal);
    for (Eigen::Index j = 0; j < count; ++j) {
      const double expected = j != k ? 0.0 : k == 0 ? 37.0 : 18.5;
      EXPECT_NEAR(coefficients[j], expected, 1e-11) << "coefficient " << j << " of cosine " << k;
    }
  }
}

TEST(Dct, OfNothingIsNothing) { EXPECT_EQ(dct(Eigen::VectorXd()).size(), 0); }

TEST(FirstPrincipalComponent, IsTheDirectionOfMostVarianceAboutTheMean) {
  const Eigen::Vector3d direction = Eigen::Vector3d(2, -1, 2) / 3;
  const Eigen::Vector3d across = Eigen::Vector3d(1, 2, 0) / std::sqrt(5.0);
  Eigen::MatrixXd rows(100, 3);
  for (Eigen::Index n = 0; n < 100; ++n) {
    // The large constant must not count.
    rows.row(n) =
        (cosine(3, n, 100) * direction + 0.3 * cosine(4, n, 100) * across).transpose() + Eigen::RowVector3d(0, 0, 50);
  }
  EXPECT_LT((first_principal_component(rows) - direction).norm(), 1e-10);
}

TEST(FirstPrincipalComponent, OfAConstantIsAUnitVector) {
  EXPECT_EQ(first_principal_component(Eigen::MatrixXd::Constant(5, 2, 3.0)).norm(), 1.0);
}

TEST(DominantHalfCycles, AreThePeakOfTheWeightedResidual) {
  const Eigen::Index count = 120;
  Eigen::MatrixXf residual(count, 2);
  for (Eigen::Index n = 0; n < count; ++n) {
    residual(n, 0) = static_cast<float>(cosine(7, n, count) + 0.5 * cosine(20, n, count) + 9);
    residual(n, 1) = static_cast<float>(2 * cosine(11, n, count));
  }
  EXPECT_EQ(dominant_half_cycles(residual, Eigen::Vector2f(1, 1), {}), 11);
  EXPECT_EQ(dominant_half_cycles(residual, Eigen::Vector2f(1, 0.1f), {}), 7);
  EXPECT_EQ(dominant_half_cycles(residual, Eigen::Vector2f(1, 0.1f), std::vector<int>{7}), 20);
}

TEST(DominantHalfCycles, AreNoneWhereNoneIsLeft) {
  EXPECT_EQ(dominant_half_cycles(Eigen::MatrixXf::Ones(1, 3), Eigen::Vector3f::Ones(), {}), 0);
  EXPECT_EQ(dominant_half_cycles(Eigen::MatrixXf::Random(3, 3), Eigen::Vector3f::Ones(), std::vector<int>{2, 1}), 0);
}

}  // namespace
