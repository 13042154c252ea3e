// The pruned search for the worst point against looking at every point.
#include "motion/point_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace nmc::motion {
namespace {

constexpr int nodes = 12;

class PointSearchTest : public ::testing::Test {
 protected:
  double next() { return normal_(engine_); }

  Points random_points(int count) {
    Points points;
    for (int p = 0; p < count; ++p) {
      std::vector<Influence> influences;
      const int leading = static_cast<int>(engine_() % nodes);
      for (int k = 0; k < p % 5; ++k) {  // 0 to 4 influences
        influences.push_back({(leading + k) % nodes, {next(), 3 * next(), next()}, k == 3 ? -0.1 : 1.0 / (k + 1)});
      }
      points.add(influences.data(), influences.data() + influences.size());
    }
    return points;
  }

  std::vector<glm::dmat4> random_difference(double scale) {
    std::vector<glm::dmat4> difference(nodes, glm::dmat4(0.0));
    for (glm::dmat4& d : difference) {
      const double size = scale * std::exp(2 * next());
      for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 3; ++r) d[c][r] = size * next();
      }
    }
    return difference;
  }

 private:
  std::mt19937 engine_{99};
  std::normal_distribution<double> normal_;
};

TEST_F(PointSearchTest, FindsWhatLookingAtAllFinds) {
  for (const int count : {1, 5, 24, 25, 300, 3000, 20000}) {
    const Points points = random_points(count);
    const PointSearch search(points);
    WorstPoint running;
    double running_truth = 0;
    for (int trial = 0; trial < 50; ++trial) {
      const std::vector<glm::dmat4> difference = random_difference(trial % 7 == 0 ? 1.0 : 0.01);
      double truth = 0;
      for (std::size_t p = 0; p < points.size(); ++p) {
        truth = std::max(truth, glm::length(point_error(points, p, difference)));
      }
      WorstPoint worst;
      search.raise(difference, worst);
      EXPECT_NEAR(worst.error, truth, 1e-12 * truth);
      if (truth > 0) {
        EXPECT_NEAR(glm::length(point_error(points, static_cast<std::size_t>(worst.point), difference)), truth,
                    1e-12 * truth);
      }
      running_truth = std::max(running_truth, truth);
      search.raise(difference, running);
      EXPECT_NEAR(running.error, running_truth, 1e-12 * running_truth);
    }
  }
}

TEST_F(PointSearchTest, NothingMovedIsNoPoint) {
  const PointSearch search(random_points(100));
  WorstPoint worst;
  search.raise(std::vector<glm::dmat4>(nodes, glm::dmat4(0.0)), worst);
  EXPECT_EQ(worst.error, 0.0);
  EXPECT_EQ(worst.point, -1);
  PointSearch(Points{}).raise({}, worst);
  EXPECT_EQ(worst.error, 0.0);
}

TEST_F(PointSearchTest, NotANumberIsInfinitelyWrong) {
  const Points points = random_points(1000);
  const PointSearch search(points);
  for (int node = 0; node < nodes; ++node) {
    std::vector<glm::dmat4> difference = random_difference(1.0);
    difference[static_cast<std::size_t>(node)][node % 4][node % 3] = std::numeric_limits<double>::quiet_NaN();
    WorstPoint worst;
    search.raise(difference, worst);
    EXPECT_EQ(worst.error, std::numeric_limits<double>::infinity()) << node;
  }
}

}  // namespace
}  // namespace nmc::motion
