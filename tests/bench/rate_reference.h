// The file that everything is measured against, and the error of a file made from it.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/animation.h"
#include "base/points.h"
#include "gltf/asset.h"
#include "gltf/document.h"
#include "motion/error.h"
#include "motion/skeleton.h"

namespace nmc::bench {

/// Shares of the character's size, the largest over all animations. Infinite where an animation is missing.
struct FileError {
  double all = 0;                   ///< joints and all skin points
  double joints = 0;                ///< joints alone
  double jitter = 0;                ///< motion::ErrorReport
  std::optional<double> loop_seam;  ///< likewise; empty where no animation is a loop
  double contact_drift = 0;
};

class Reference {
 public:
  explicit Reference(const std::filesystem::path& path);
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;

  const gltf::Document& document() const { return document_; }
  double size() const { return size_; }
  double key_rate_hz() const;  ///< of the longest animation

  /// The other file's animations against this one's. Its nodes may be others in another order, as gltfpack makes them:
  /// they are found by name, else by their place in a skin, else (in a file of as many nodes) by index. Animations are
  /// found by name, else by index.
  FileError error(const gltf::Document& other) const;

 private:
  gltf::Document document_;
  gltf::Asset asset_;
  motion::Skeleton skeleton_;
  Points points_;
  motion::ErrorMeter meter_;
  double size_ = 1;
  std::vector<Animation> animations_;
};

}  // namespace nmc::bench
