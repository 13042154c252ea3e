#include "comparison_measures.h"

#include <time.h>

#include <algorithm>
#include <cmath>

#include "gltf/document.h"
#include "motion/index.h"
#include "motion/pose.h"

namespace nmc::bench {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::unique_ptr<codec::Source> read_motion(const std::filesystem::path& path) {
  return std::make_unique<codec::Source>(codec::read_source(gltf::read_document(path), {}));
}

std::size_t frame_count(const codec::Source& source) {
  std::size_t frames = 0;
  for (const codec::ClipSource& clip : source.clips) frames += clip.clip.times.size();
  return frames;
}

std::size_t raw_joint_bytes(const codec::Source& source) {
  return 4 * (3 * source.skeleton.joints.size() + 3) * frame_count(source);
}

PaperMeasures measure_as_papers(const codec::Source& source, const std::vector<motion::Clip>& decoded) {
  PaperMeasures measures;
  double sum = 0, count = 0, worst = 0, squares = 0, spread = 0;
  const std::vector<int>& joints = source.skeleton.joints;
  for (std::size_t c = 0; c < source.clips.size(); ++c) {
    const codec::ClipSource& clip = source.clips[c];
    const Animation other = codec::with_kept(clip, decoded[c]);
    motion::PoseReader a(source.skeleton, clip.original), b(source.skeleton, other);
    std::vector<glm::dvec3> means(joints.size(), glm::dvec3(0.0));
    std::vector<std::vector<glm::dvec3>> positions;
    for (const float t : clip.clip.times) {
      a.read(t);
      b.read(t);
      positions.emplace_back();
      for (std::size_t j = 0; j < joints.size(); ++j) {
        const glm::dvec3 p(a.world()[motion::at(joints[j])][3]);
        const glm::dvec3 by = glm::dvec3(b.world()[motion::at(joints[j])][3]) - p;
        const double error = glm::length(by);
        sum += error;
        ++count;
        worst = std::max(worst, error);
        squares += error * error;
        means[j] += p / static_cast<double>(clip.clip.times.size());
        positions.back().push_back(p);
      }
    }
    for (const std::vector<glm::dvec3>& frame : positions)
      for (std::size_t j = 0; j < joints.size(); ++j) spread += std::pow(glm::length(frame[j] - means[j]), 2);
  }
  measures.mean_joint_cm = 100 * sum / std::max(1.0, count);
  measures.max_joint_share = worst / source.size;
  measures.distortion_percent = spread > 0 ? 100 * std::sqrt(squares / spread) : 0;
  return measures;
}

}  // namespace nmc::bench
