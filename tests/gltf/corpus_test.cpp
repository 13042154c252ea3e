// Real files: all of them are read, and some of what they hold is known.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "gltf/asset.h"

namespace {

namespace fs = std::filesystem;
using nmc::gltf::Asset;

const fs::path data_folder = fs::path(NMC_SHARED_DIR) / "data";

std::vector<fs::path> models_in(const char* folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(data_folder / folder)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".glb" || extension == ".gltf") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

Asset read(const char* name) { return read_asset(nmc::gltf::read_document(data_folder / name)); }

class Corpus : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(data_folder)) GTEST_SKIP() << "no shared data";
  }
};

TEST_F(Corpus, EveryValidFileIsRead) {
  for (const char* folder : {"game", "mocap", "odd"}) {
    for (const fs::path& path : models_in(folder)) {
      SCOPED_TRACE(path);
      const nmc::gltf::Document document = nmc::gltf::read_document(path);
      Asset asset;
      ASSERT_NO_THROW(asset = read_asset(document));
      EXPECT_EQ(asset.animations.size(), document.json["animations"].size());
      EXPECT_EQ(asset.order.size(), asset.nodes.size());
      for (std::size_t a = 0; a < asset.animations.size(); ++a) {
        EXPECT_EQ(asset.animations[a].channels.size() + asset.animations[a].untouched.size(),
                  document.json["animations"][a]["channels"].size());
      }
    }
  }
}

TEST_F(Corpus, InvalidFilesAreReadOrRefusedWithASentence) {
  for (const fs::path& path : models_in("invalid")) {
    SCOPED_TRACE(path);
    try {
      read_asset(nmc::gltf::read_document(path));
    } catch (const nmc::Error& error) {
      EXPECT_NE(error.code(), nmc::ErrorCode::internal) << error.what();
      EXPECT_THAT(error.what(), testing::HasSubstr(path.stem().string()));
    }
  }
}

TEST_F(Corpus, FoxHasThreeAnimationsAndUnevenKeys) {
  const Asset asset = read("game/fox.glb");
  ASSERT_EQ(asset.animations.size(), 3u);
  EXPECT_EQ(asset.animations[0].name, "Survey");
  ASSERT_EQ(asset.skins.size(), 1u);
  EXPECT_EQ(asset.skins[0].joints.size(), 24u);
  double largest = 0;
  double smallest = 1e9;
  for (const auto& animation : asset.animations) {
    for (const auto& channel : animation.channels) {
      for (std::size_t i = 1; i < channel.curve.times.size(); ++i) {
        const double step = double{channel.curve.times[i]} - double{channel.curve.times[i - 1]};
        largest = std::max(largest, step);
        smallest = std::min(smallest, step);
      }
    }
  }
  EXPECT_GT(largest, 1.5 * smallest);
}

/// Values that agree to the 12 bits that the packed file keeps, relative to the largest number of the key as meshopt's
/// exponential filter keeps them; a quaternion and its negative are the same rotation.
void expect_near(const nmc::Curve& a, const nmc::Curve& b) {
  const auto width = static_cast<std::size_t>(a.width);
  for (std::size_t row = 0; row < a.values.size(); row += width) {
    float dot = 0;
    float largest = 0;
    for (std::size_t i = row; i < row + width; ++i) {
      dot += a.values[i] * b.values[i];
      largest = std::max(largest, std::abs(b.values[i]));
    }
    const float tolerance = largest / 2048.0f;
    const float sign = a.path == nmc::Path::rotation && dot < 0 ? -1.0f : 1.0f;
    for (std::size_t i = row; i < row + width; ++i) ASSERT_NEAR(a.values[i], sign * b.values[i], tolerance);
  }
}

/// Curves of two files that hold the same animation up to quantization.
void expect_similar(const Asset& a, const Asset& b) {
  ASSERT_EQ(a.animations.size(), b.animations.size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < a.animations.size(); ++i) {
    for (const auto& channel : a.animations[i].channels) {
      for (const auto& other : b.animations[i].channels) {
        const auto& name = a.nodes[static_cast<std::size_t>(channel.curve.node)].name;
        if (name.empty() || name != b.nodes[static_cast<std::size_t>(other.curve.node)].name) continue;
        if (channel.curve.path != other.curve.path || channel.curve.times != other.curve.times) continue;
        ++compared;
        ASSERT_EQ(channel.curve.values.size(), other.curve.values.size());
        expect_near(channel.curve, other.curve);
      }
    }
  }
  EXPECT_GT(compared, 30u);
}

TEST_F(Corpus, MeshoptHoldsWhatThePlainFileHolds) {
  expect_similar(read("odd/Fox_meshopt.glb"), read("odd/Fox_resample.glb"));
}

TEST_F(Corpus, CubicSplinesAndStepsAreToldApart) {
  const Asset asset = read("odd/InterpolationTest.glb");
  std::size_t cubic = 0;
  std::size_t untouched = 0;
  for (const auto& animation : asset.animations) {
    untouched += animation.untouched.size();
    for (const auto& channel : animation.channels) {
      if (channel.curve.interpolation != nmc::Interpolation::cubic_spline) continue;
      ++cubic;
      EXPECT_EQ(channel.curve.values.size(),
                3 * channel.curve.times.size() * static_cast<std::size_t>(channel.curve.width));
    }
  }
  EXPECT_EQ(cubic, 3u);
  EXPECT_EQ(untouched, 3u);
}

}  // namespace
