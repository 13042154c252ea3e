// A small language for parts of bodies: blobs said by joint names, with mirror images.
#pragma once

#include <string>
#include <utility>

#include "samples/rig.h"
#include "samples/shape.h"

namespace nmc::samples {

/// Builds blobs from joints and their mirror images.
class Sculptor {
 public:
  Sculptor(const Rig& rig, Part part) : rig_(rig), part_(std::move(part)) {}

  Sculptor& blob(const std::string& joint, const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b,
                 double flatness = 1.0, const glm::dvec3& flat = glm::dvec3(0, 0, 1)) {
    part_.blobs.push_back({rig_.find(joint), a, b, radius_a, radius_b, flat, flatness, false, own_smoothness_});
    return *this;
  }
  /// From a joint's head to its tail.
  Sculptor& bone(const std::string& joint, double radius_a, double radius_b) {
    const Joint& j = rig_.joints[static_cast<std::size_t>(rig_.find(joint))];
    return blob(joint, j.head, j.tail, radius_a, radius_b);
  }
  /// A left blob and its mirror image.
  Sculptor& pair(const std::string& joint, const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b,
                 double flatness = 1.0, const glm::dvec3& flat = glm::dvec3(0, 0, 1)) {
    blob(joint + "_l", a, b, radius_a, radius_b, flatness, flat);
    return blob(joint + "_r", mirrored(a), mirrored(b), radius_a, radius_b, flatness, mirrored(flat));
  }
  Sculptor& bone_pair(const std::string& joint, double radius_a, double radius_b) {
    return bone(joint + "_l", radius_a, radius_b).bone(joint + "_r", radius_a, radius_b);
  }
  /// Takes a ball away.
  Sculptor& carve(const std::string& joint, const glm::dvec3& at, double radius) {
    part_.blobs.push_back({rig_.find(joint), at, at, radius, radius, {0, 0, 1}, 1.0, true, 0.0});
    return *this;
  }
  /// The blend width of the blobs that follow, metres; 0 is the part's.
  Sculptor& smoothness(double metres) {
    own_smoothness_ = metres;
    return *this;
  }
  glm::dvec3 head_of(const std::string& joint) const {
    return rig_.joints[static_cast<std::size_t>(rig_.find(joint))].head;
  }
  glm::dvec3 tail_of(const std::string& joint) const {
    return rig_.joints[static_cast<std::size_t>(rig_.find(joint))].tail;
  }
  Part part() const { return part_; }

 private:
  const Rig& rig_;
  Part part_;
  double own_smoothness_ = 0.0;
};

}  // namespace nmc::samples
