// Reads two files, matches their animations, and follows the points that are worst.
#include "codec/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "codec/matching.h"
#include "gltf/asset.h"
#include "motion/pose.h"

namespace nmc::codec {
namespace {

constexpr std::size_t most_traces = 4;

/// A surface with more takes long to load in a page, and to draw without a graphics card.
constexpr std::size_t most_vertices = 50'000, most_corners = 300'000;

int leading_node(const Points& points, std::size_t point) {
  return points.influences[static_cast<std::size_t>(motion::leading_influence(points, point))].node;
}

/// The points that are the worst ones at some time, worst first, one of each node.
std::vector<std::size_t> worst_points(const Points& points, const motion::ErrorProfile& profile) {
  std::vector<std::size_t> order(profile.seconds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return profile.max_error[a] > profile.max_error[b]; });
  std::vector<std::size_t> chosen;
  std::vector<int> nodes;
  for (const std::size_t k : order) {
    if (profile.worst_point[k] < 0) continue;
    const auto point = static_cast<std::size_t>(profile.worst_point[k]);
    const int node = leading_node(points, point);
    if (std::find(nodes.begin(), nodes.end(), node) != nodes.end()) continue;
    nodes.push_back(node);
    chosen.push_back(point);
    if (chosen.size() == most_traces) break;
  }
  return chosen;
}

std::vector<PointTrace> trace(const motion::Skeleton& skeleton, const Points& points, const ComparedClip& clip) {
  const std::vector<std::size_t> chosen = worst_points(points, clip.profile);
  std::vector<PointTrace> traces;
  for (const std::size_t point : chosen) traces.push_back({leading_node(points, point), {}});
  if (chosen.empty()) return traces;
  motion::PoseReader original(skeleton, clip.original), other(skeleton, clip.other);
  std::vector<glm::dmat4> difference(skeleton.size());
  for (const double seconds : clip.profile.seconds) {
    original.read(seconds);
    other.read(seconds);
    for (std::size_t n = 0; n < difference.size(); ++n) difference[n] = other.world()[n] - original.world()[n];
    for (std::size_t i = 0; i < chosen.size(); ++i)
      traces[i].error.push_back(
          motion::number_or_infinity(glm::length(motion::point_error(points, chosen[i], difference))));
  }
  return traces;
}

/// The curves of an animation that its file has as channels.
Animation channels_of(const Animation& animation, const gltf::AnimationSource& source) {
  Animation found{animation.name, {}};
  const auto is_channel = [&](const Curve& curve) {
    return std::any_of(source.channels.begin(), source.channels.end(),
                       [&](const gltf::Channel& channel) { return channel.curve == curve; }) ||
           std::any_of(source.untouched.begin(), source.untouched.end(),
                       [&](const gltf::UntouchedChannel& channel) { return channel.curve == curve; });
  };
  std::copy_if(animation.curves.begin(), animation.curves.end(), std::back_inserter(found.curves), is_channel);
  return found;
}

}  // namespace

Comparison compare(const gltf::Document& original, const gltf::Document& other, std::size_t bytes_before,
                   std::size_t bytes_after, int threads) {
  const gltf::Asset a = gltf::read_asset(original), b = gltf::read_asset(other);
  check_nodes(original, a, other, b);
  Comparison result;
  result.skeleton = make_skeleton(a);
  const Points points = gltf::skin_points(original, a, true);
  const motion::ErrorMeter meter(result.skeleton, points);
  result.size = motion::character_size(result.skeleton, points);
  result.triangles = gltf::read_triangles(original, a, most_vertices, most_corners);
  result.before = gltf::byte_parts(original, bytes_before);
  result.after = gltf::byte_parts(other, bytes_after);
  gltf::CompressedContent content = gltf::read_compression(other);
  const std::vector<Animation> wanted = all_animations(original, a);
  const std::vector<Animation> got = all_animations(other, b);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].curves.empty()) continue;
    const std::size_t found = find_match(original, wanted, other, got, i);
    ComparedClip clip;
    clip.animation = static_cast<int>(i);
    clip.name = wanted[i].name;
    clip.original = wanted[i];
    clip.other = got[found];
    for (const gltf::CompressedAnimation& animation : content.animations) {
      if (animation.animation != static_cast<int>(found)) continue;
      clip.clip_set = animation.clip_set;
      clip.clip = animation.clip;
    }
    clip.beside = clip.clip_set < 0 ? clip.other : channels_of(clip.other, b.animations[found]);
    result.clips.push_back(std::move(clip));
  }
  result.clip_sets = std::move(content.clip_sets);
  parallel_for(result.clips.size(), threads, [&](std::size_t i) {
    ComparedClip& clip = result.clips[i];
    clip.profile = meter.profile(clip.original, clip.other);
    clip.worst = trace(result.skeleton, points, clip);
  });
  return result;
}

}  // namespace nmc::codec
