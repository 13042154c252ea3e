#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace {

TEST(ParallelFor, VisitsEveryItemOnce) {
  for (const int threads : {1, 2, 8}) {
    std::vector<std::atomic<int>> visits(1000);
    nmc::parallel_for(visits.size(), threads, [&](std::size_t i) { ++visits[i]; });
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
}

TEST(ParallelFor, RethrowsTheFailure) {
  EXPECT_THROW(nmc::parallel_for(100, 4,
                                 [](std::size_t i) {
                                   if (i == 37) throw std::runtime_error("37");
                                 }),
               std::runtime_error);
}

TEST(ParallelFor, NoItemsIsNoWork) {
  nmc::parallel_for(0, 4, [](std::size_t) { FAIL(); });
}

}  // namespace
