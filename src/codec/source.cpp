#include "codec/source.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "codec/resting.h"
#include "motion/error.h"

namespace nmc::codec {
namespace {

glm::dmat4 matrix_of(const gltf::Node& node) {
  glm::dmat4 m;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) m[column][row] = node.matrix[static_cast<std::size_t>(4 * column + row)];
  return m;
}

motion::Transform transform_of(const gltf::Node& node) {
  motion::Transform t;
  t.translation = {node.translation[0], node.translation[1], node.translation[2]};
  t.rotation = glm::normalize(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
  t.scale = {node.scale[0], node.scale[1], node.scale[2]};
  return t;
}

Points points_of_joints(const motion::Skeleton& skeleton) {
  Points points;
  for (const int joint : skeleton.joints) {
    const Influence origin{joint, {}, 1.0};
    points.add(&origin, &origin + 1);
  }
  return points;
}

bool is_kept(const std::string& clip, const Curve& curve, const motion::Skeleton& skeleton,
             const CompressOptions& options) {
  return std::any_of(options.keep.begin(), options.keep.end(), [&](const Selector& selector) {
    return selects_clip(selector, clip) &&
           selects_channel(selector, skeleton.names[static_cast<std::size_t>(curve.node)], curve.path);
  });
}

bool is_excluded(const std::string& name, const CompressOptions& options) {
  return std::find(options.exclude.begin(), options.exclude.end(), name) != options.exclude.end();
}

/// Smooth curves are sampled so densely that straight lines between samples use up a small part of the tolerance only.
constexpr double sampling_share = 0.2;

/// The curve's first value, held from its first to its last key.
Curve held(const Curve& curve) {
  Curve constant = curve;
  constant.interpolation = Interpolation::linear;
  constant.times = {curve.times.front()};
  if (curve.times.size() > 1) constant.times.push_back(curve.times.back());
  constant.values.clear();
  for (std::size_t k = 0; k < constant.times.size(); ++k)
    constant.values.insert(constant.values.end(), curve.values.begin(), curve.values.begin() + curve.width);
  return constant;
}

/// `resting` only have a say in how long the clip is.
motion::Clip make_clip(const std::string& name, std::vector<Curve> curves, const std::vector<Curve>& resting,
                       double tolerance, double size) {
  const double distance = sampling_share * tolerance;
  const int parts = motion::needed_subdivisions(curves, distance / size, distance);
  std::transform(resting.begin(), resting.end(), std::back_inserter(curves), held);
  const std::vector<float> times = motion::common_times(curves, parts);
  curves.resize(curves.size() - resting.size());
  return motion::sample_clip(name, curves, times);
}

/// Moves the curves of these properties, and the numbers of their channels, out of a clip; one of its curves stays.
std::vector<Curve> leave_out(const std::set<NodeProperty>& resting, std::vector<Curve>& curves, ClipSource& clip) {
  std::vector<Curve> left_out, stay;
  std::vector<int> channels;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const bool is_last = k + 1 == curves.size() && stay.empty();
    if (is_last || !resting.contains({curves[k].node, curves[k].path})) {
      stay.push_back(std::move(curves[k]));
      channels.push_back(clip.channels[k]);
    } else {
      left_out.push_back(std::move(curves[k]));
      clip.resting.push_back(clip.channels[k]);
    }
  }
  curves = std::move(stay);
  clip.channels = std::move(channels);
  return left_out;
}

/// Exporters write constants as STEP keys that differ by rounding; less than this share of the tolerance is not a jump.
constexpr double rounding_share = 0.02;

bool is_steady(const Curve& curve, double tolerance, double size) {
  const double most = rounding_share * tolerance / (curve.path == Path::translation ? 1.0 : size);
  const auto width = static_cast<std::size_t>(curve.width);
  for (std::size_t i = width; i < curve.values.size(); ++i)
    if (!(std::abs(static_cast<double>(curve.values[i]) - static_cast<double>(curve.values[i % width])) <= most))
      return false;
  return true;
}

/// A channel that changes in jumps only, none of which anyone sees.
bool is_constant_enough(const gltf::UntouchedChannel& channel, double tolerance, double size) {
  const Curve& curve = channel.curve;
  return curve.node >= 0 && curve.interpolation == Interpolation::step && !curve.times.empty() &&
         is_steady(curve, tolerance, size);
}

/// Whether any animation moves a node: without motion nobody looks at the meshes, and what is wrong in them can stay.
bool has_motion(const gltf::Asset& asset) {
  return std::any_of(asset.animations.begin(), asset.animations.end(), [](const gltf::AnimationSource& animation) {
    return !animation.channels.empty() ||
           std::any_of(animation.untouched.begin(), animation.untouched.end(),
                       [](const gltf::UntouchedChannel& channel) { return channel.curve.node >= 0; });
  });
}

/// Of all points in all animations that are to be compressed, world units.
double finest_tolerance(const gltf::Asset& asset, const CompressOptions& options, BoundTable& bounds) {
  double finest = std::numeric_limits<double>::infinity();
  for (const gltf::AnimationSource& animation : asset.animations)
    if (!is_excluded(animation.name, options))
      finest = std::min(finest, bounds.bounds()[bounds.of(animation.name)].finest);
  return finest;
}

std::size_t animated_nodes(const motion::Clip& clip) {
  std::set<int> nodes;
  for (const motion::Track& track : clip.tracks) nodes.insert(track.node);
  return nodes.size();
}

}  // namespace

motion::Skeleton make_skeleton(const gltf::Asset& asset) {
  motion::Skeleton skeleton;
  skeleton.order = asset.order;
  for (const gltf::Node& node : asset.nodes) {
    skeleton.names.push_back(node.name);
    skeleton.parent.push_back(node.parent);
    skeleton.rest.push_back(node.has_matrix ? motion::decompose(matrix_of(node)) : transform_of(node));
    skeleton.rest_matrix.push_back(node.has_matrix ? matrix_of(node) : motion::to_matrix(skeleton.rest.back()));
    skeleton.rest_weights.push_back(node.weights);
  }
  std::set<int> joints;
  for (const gltf::Skin& skin : asset.skins) joints.insert(skin.joints.begin(), skin.joints.end());
  skeleton.joints.assign(joints.begin(), joints.end());
  return skeleton;
}

Source read_source(const gltf::Document& document, const CompressOptions& options) {
  Source source;
  gltf::Asset asset = gltf::read_asset(document);
  source.skeleton = make_skeleton(asset);
  if (has_motion(asset)) {
    source.points = gltf::skin_points(document, asset);
    source.all_points = gltf::skin_points(document, asset, true);
  }
  source.joint_points = source.skeleton.joints.empty() ? source.points : points_of_joints(source.skeleton);
  source.size = motion::character_size(source.skeleton, source.all_points);
  source.tolerance = in_world_units(options.tolerance, source.size);
  BoundTable bounds({source.skeleton, source.points, source.all_points, source.size, source.tolerance}, options.rules);
  std::set<NodeProperty> resting;
  if (options.profile == Profile::standard && !options.keep_resting)
    resting =
        resting_properties(document, asset, source.skeleton, finest_tolerance(asset, options, bounds), source.size);
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    gltf::AnimationSource& animation = asset.animations[i];
    ClipResult result;
    result.animation = static_cast<int>(i);
    result.name = animation.name;
    result.tolerance = result.finest_tolerance = source.tolerance;
    if (is_excluded(animation.name, options))
      result.reason = "excluded";
    else if (animation.channels.empty() && animation.untouched.empty())
      result.reason = "it has no channels";
    source.results.push_back(result);
    if (!result.reason.empty()) continue;
    ClipSource clip;
    clip.animation = static_cast<int>(i);
    clip.name = animation.name;
    clip.original.name = clip.kept.name = animation.name;
    clip.bound = bounds.of(animation.name);
    const double tolerance = bounds.bounds()[clip.bound].finest;
    source.results.back().tolerance = bounds.bounds()[clip.bound].tolerance;
    source.results.back().finest_tolerance = tolerance;
    std::vector<Curve> taken;
    for (gltf::Channel& channel : animation.channels) {
      clip.original.curves.push_back(std::move(channel.curve));
      const Curve& curve = clip.original.curves.back();
      if (is_kept(animation.name, curve, source.skeleton, options)) {
        clip.kept.curves.push_back(curve);
        continue;
      }
      clip.channels.push_back(channel.channel);
      taken.push_back(curve);
    }
    for (const gltf::UntouchedChannel& channel : animation.untouched) {
      if (channel.curve.node < 0) continue;
      clip.original.curves.push_back(channel.curve);
      if (is_constant_enough(channel, tolerance, source.size) &&
          !is_kept(animation.name, channel.curve, source.skeleton, options)) {
        clip.channels.push_back(channel.channel);
        taken.push_back(held(channel.curve));
      } else {
        clip.kept.curves.push_back(channel.curve);
      }
    }
    if (taken.empty()) {
      source.results.back().reason =
          animation.channels.empty() ? animation.untouched.front().reason : "all its channels are to be kept";
      continue;
    }
    const std::vector<Curve> left_out = leave_out(resting, taken, clip);
    clip.clip = make_clip(animation.name, std::move(taken), left_out, tolerance, source.size);
    ClipResult& made = source.results.back();
    made.frames = clip.clip.times.size();
    made.joints = animated_nodes(clip.clip);
    made.duration_seconds = static_cast<double>(clip.clip.times.back()) - clip.clip.times.front();
    source.clips.push_back(std::move(clip));
  }
  source.bounds = bounds.take();
  return source;
}

Source with_tolerance(Source source, double tolerance) {
  source.tolerance = tolerance;
  source.bounds = {{tolerance, tolerance, {}, {}}};
  for (ClipSource& clip : source.clips) clip.bound = 0;
  for (ClipResult& result : source.results) result.tolerance = result.finest_tolerance = tolerance;
  return source;
}

const Points& points_of(const Source& source, const Bound& bound) {
  return bound.points ? *bound.points : source.points;
}

const Points& all_points_of(const Source& source, const Bound& bound) {
  return bound.all_points ? *bound.all_points : source.all_points;
}

std::vector<std::string> unused_patterns(const Source& source, const CompressOptions& options) {
  std::vector<std::string> sentences;
  const auto check = [&](const Selector& where) {
    const bool clip = std::any_of(source.results.begin(), source.results.end(),
                                  [&](const ClipResult& c) { return selects_clip(where, c.name); });
    const bool joint = std::any_of(source.skeleton.names.begin(), source.skeleton.names.end(),
                                   [&](const auto& name) { return where.joint.empty() || matches(where.joint, name); });
    if (!clip) sentences.push_back("no animation's name fits '" + where.clip + "'");
    if (!joint) sentences.push_back("no node's name fits '" + where.joint + "'");
  };
  for (const ToleranceRule& rule : options.rules) check(rule.where);
  for (const Selector& selector : options.keep) check(selector);
  return sentences;
}

Animation with_kept(const ClipSource& source, const motion::Clip& decoded) {
  Animation all = motion::to_animation(decoded);
  all.curves.insert(all.curves.end(), source.kept.curves.begin(), source.kept.curves.end());
  return all;
}

std::vector<NodeTarget> common_targets(const motion::Skeleton& skeleton,
                                       const std::vector<const motion::Clip*>& clips) {
  std::vector<std::size_t> rank(skeleton.size());
  for (std::size_t i = 0; i < skeleton.order.size(); ++i) rank[static_cast<std::size_t>(skeleton.order[i])] = i;
  std::map<std::pair<Path, std::size_t>, NodeTarget> found;
  for (const motion::Clip* clip : clips)
    for (const motion::Track& track : clip->tracks)
      found[{track.path, rank[static_cast<std::size_t>(track.node)]}] = {track.node, track.path, track.width};
  std::vector<NodeTarget> targets;
  for (const auto& [key, target] : found) targets.push_back(target);
  return targets;
}

std::vector<int> nodes_of(const EncodedSet& set) {
  std::vector<int> nodes;
  for (const NodeTarget& target : set.targets) nodes.push_back(target.node);
  return nodes;
}

gltf::CompressionEdit compression_edit(const Source& source, const std::vector<EncodedSet>& sets) {
  gltf::CompressionEdit edit;
  for (const EncodedSet& set : sets) {
    gltf::ClipSetBytes bytes;
    bytes.stream = set.stream;
    for (const NodeTarget& target : set.targets) bytes.targets.push_back({target.node, target.path});
    for (std::size_t i = 0; i < set.clips.size(); ++i) {
      const ClipSource& clip = source.clips[set.clips[i]];
      edit.taken.push_back({clip.animation,
                            clip.channels,
                            static_cast<int>(edit.clip_sets.size()),
                            static_cast<int>(i),
                            clip.clip.times.front(),
                            clip.clip.times.back(),
                            {},
                            clip.resting});
    }
    edit.clip_sets.push_back(std::move(bytes));
  }
  std::sort(edit.taken.begin(), edit.taken.end(),
            [](const auto& a, const auto& b) { return a.animation < b.animation; });
  return edit;
}

const motion::Track* find_track(const motion::Clip& clip, const NodeTarget& target) {
  for (const motion::Track& track : clip.tracks)
    if (track.node == target.node && track.path == target.path) return &track;
  return nullptr;
}

}  // namespace nmc::codec
