// Packs what the page plays and draws: keys in 16 bits, error curves thinned to what a screen shows.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "base/base64.h"
#include "motion/curve.h"
#include "report/compress_report.h"
#include "report/html_report.h"

namespace nmc::report {
namespace {

using Json = nlohmann::ordered_json;

/// Beyond as many 16-bit numbers the page would be slow to load; further clips show without their original.
constexpr std::size_t most_levels = std::size_t{6} << 20;

/// Times of an error curve in the page; each keeps the largest error around it.
constexpr std::size_t most_samples = 600;

/// Straight keys between two keys of a CUBICSPLINE curve.
constexpr int cubic_parts = 4;

template <class T>
std::string base64_of(const std::vector<T>& values) {
  return base64({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)});
}

/// Keys of many clips in two arrays: 16-bit levels, and floats for times and ranges.
class KeyPacker {
 public:
  /// The motion, or null where there is no more room.
  Json pack(const motion::Skeleton& skeleton, const Animation& animation) {
    std::size_t needed = 0;
    for (const Curve& curve : animation.curves) needed += curve.values.size();
    if (levels_.size() + needed > most_levels) return nullptr;
    Json tracks = Json::array();
    for (const Curve& curve : animation.curves) {
      if (curve.path == Path::weights || curve.times.empty() || is_rest(skeleton, curve)) continue;
      pack_curve(curve, tracks);
    }
    return tracks;
  }

  Json json() const { return {{"levels", base64_of(levels_)}, {"numbers", base64_of(numbers_)}}; }

 private:
  static bool is_rest(const motion::Skeleton& skeleton, const Curve& curve) {
    if (curve.interpolation == Interpolation::cubic_spline) return false;
    const motion::Transform& rest = skeleton.rest[static_cast<std::size_t>(curve.node)];
    const glm::dquat& r = rest.rotation;
    const std::array<double, 4> value =
        curve.path == Path::rotation ? std::array<double, 4>{r.x, r.y, r.z, r.w}
        : curve.path == Path::scale
            ? std::array<double, 4>{rest.scale.x, rest.scale.y, rest.scale.z, 0}
            : std::array<double, 4>{rest.translation.x, rest.translation.y, rest.translation.z, 0};
    const auto width = static_cast<std::size_t>(curve.width);
    for (std::size_t i = 0; i < curve.values.size(); ++i)
      if (std::abs(static_cast<double>(curve.values[i]) - value[i % width]) > 1e-6) return false;
    return true;
  }

  void pack_curve(const Curve& curve, Json& tracks) {
    std::vector<float> times = curve.times, values = curve.values;
    const auto width = static_cast<std::size_t>(curve.width);
    if (curve.interpolation == Interpolation::cubic_spline) straighten(curve, times, values);
    if (is_constant(values, width)) {
      times.resize(1);
      values.resize(width);
    }
    if (curve.path == Path::rotation) make_continuous(values);
    tracks.insert(tracks.end(),
                  {curve.node, static_cast<int>(curve.path), curve.interpolation == Interpolation::step ? 1 : 0,
                   place_times(times), times.size(), levels_.size(), numbers_.size()});
    for (std::size_t a = 0; a < width; ++a) {
      float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
      for (std::size_t i = a; i < values.size(); i += width) {
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
      }
      numbers_.push_back(low);
      numbers_.push_back((high - low) / 65535);
      for (std::size_t i = a; i < values.size(); i += width)
        levels_.push_back(
            static_cast<std::uint16_t>(high > low ? std::lround((values[i] - low) / (high - low) * 65535) : 0));
    }
  }

  static bool is_constant(const std::vector<float>& values, std::size_t width) {
    for (std::size_t i = width; i < values.size(); ++i)
      if (values[i] != values[i - width]) return false;
    return true;
  }

  static void straighten(const Curve& curve, std::vector<float>& times, std::vector<float>& values) {
    times.clear();
    for (std::size_t k = 0; k + 1 < curve.times.size(); ++k)
      for (int part = 0; part < cubic_parts; ++part)
        times.push_back(curve.times[k] +
                        (curve.times[k + 1] - curve.times[k]) * static_cast<float>(part) / cubic_parts);
    times.push_back(curve.times.back());
    values.assign(times.size() * static_cast<std::size_t>(curve.width), 0);
    std::vector<double> value(static_cast<std::size_t>(curve.width));
    for (std::size_t n = 0; n < times.size(); ++n) {
      motion::evaluate(curve, static_cast<double>(times[n]), value);
      std::transform(value.begin(), value.end(), values.begin() + static_cast<std::ptrdiff_t>(n * value.size()),
                     [](double v) { return static_cast<float>(v); });
    }
  }

  static void make_continuous(std::vector<float>& q) {
    for (std::size_t k = 4; k + 3 < q.size(); k += 4) {
      float dot = 0;
      for (std::size_t a = 0; a < 4; ++a) dot += q[k + a] * q[k + a - 4];
      if (dot < 0)
        for (std::size_t a = 0; a < 4; ++a) q[k + a] = -q[k + a];
    }
  }

  /// Where equal times stand already, else at the end.
  std::size_t place_times(const std::vector<float>& times) {
    const auto [place, is_new] = places_.try_emplace(times, numbers_.size());
    if (is_new) numbers_.insert(numbers_.end(), times.begin(), times.end());
    return place->second;
  }

  std::vector<std::uint16_t> levels_;
  std::vector<float> numbers_;
  std::map<std::vector<float>, std::size_t> places_;
};

Json skeleton_json(const motion::Skeleton& skeleton) {
  std::vector<float> rest;
  Json matrices = Json::array();
  for (std::size_t n = 0; n < skeleton.size(); ++n) {
    const motion::Transform& t = skeleton.rest[n];
    for (const double v : {t.translation.x, t.translation.y, t.translation.z, t.rotation.x, t.rotation.y, t.rotation.z,
                           t.rotation.w, t.scale.x, t.scale.y, t.scale.z})
      rest.push_back(static_cast<float>(v));
    const glm::dmat4 made = motion::to_matrix(t);
    double difference = 0;
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        difference = std::max(difference, std::abs(made[c][r] - skeleton.rest_matrix[n][c][r]));
    if (difference <= 1e-6) continue;
    Json matrix = Json::array();
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r) matrix.push_back(static_cast<float>(skeleton.rest_matrix[n][c][r]));
    matrices.push_back({n, std::move(matrix)});
  }
  return {{"names", skeleton.names},   {"parent", skeleton.parent}, {"order", skeleton.order},
          {"joints", skeleton.joints}, {"rest", base64_of(rest)},   {"matrices", std::move(matrices)}};
}

/// A number as JSON holds it; infinity becomes a very large one.
float finite(double value) { return std::isfinite(value) ? static_cast<float>(value) : 1e30F; }

/// The error curves, with the largest value of each stretch.
Json profile_json(const codec::ComparedClip& clip, const std::vector<std::string>& names) {
  const std::size_t count = clip.profile.seconds.size();
  const std::size_t stretch = (count + most_samples - 1) / most_samples;
  const auto thin = [&](const std::vector<double>& values, bool largest) {
    std::vector<float> out;
    for (std::size_t i = 0; i < values.size(); i += stretch) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(i);
      const auto last = values.begin() + static_cast<std::ptrdiff_t>(std::min(i + stretch, values.size()));
      out.push_back(finite(largest ? *std::max_element(first, last) : *first));
    }
    return base64_of(out);
  };
  Json worst = Json::array();
  for (const codec::PointTrace& trace : clip.worst)
    worst.push_back(
        {{"node", trace.node}, {"name", node_label(names, trace.node)}, {"error", thin(trace.error, true)}});
  return {{"seconds", thin(clip.profile.seconds, false)},
          {"max", thin(clip.profile.max_error, true)},
          {"worst", std::move(worst)}};
}

Json parts_json(const codec::Comparison& comparison) {
  Json parts = Json::array();
  const auto add = [&](const char* name, std::size_t gltf::ByteParts::*part) {
    parts.push_back({{"name", name}, {"before", comparison.before.*part}, {"after", comparison.after.*part}});
  };
  add("meshes", &gltf::ByteParts::meshes);
  add("images", &gltf::ByteParts::images);
  add("keys", &gltf::ByteParts::keys);
  add("animation JSON", &gltf::ByteParts::animation_json);
  add("networks", &gltf::ByteParts::networks);
  add("other", &gltf::ByteParts::other);
  return parts;
}

Json triangles_json(const gltf::Triangles& triangles) {
  std::vector<float> positions, inverse_bind;
  std::vector<std::uint16_t> influences;
  std::vector<std::uint8_t> weights;
  Json nodes = Json::array();
  for (const std::array<float, 3>& p : triangles.positions) positions.insert(positions.end(), p.begin(), p.end());
  for (const std::array<std::uint16_t, 4>& b : triangles.influences)
    influences.insert(influences.end(), b.begin(), b.end());
  for (const std::array<float, 4>& w : triangles.weights)
    for (const float weight : w) weights.push_back(static_cast<std::uint8_t>(std::lround(weight * 255)));
  for (const gltf::Bone& bone : triangles.bones) {
    nodes.push_back(bone.node);
    for (const double v : bone.inverse_bind) inverse_bind.push_back(static_cast<float>(v));
  }
  return {{"nodes", std::move(nodes)},         {"inverseBind", base64_of(inverse_bind)},
          {"positions", base64_of(positions)}, {"bones", base64_of(influences)},
          {"weights", base64_of(weights)},     {"indices", base64_of(triangles.indices)}};
}

constexpr const char* path_names[] = {"translation", "rotation", "scale", "weights"};

}  // namespace

Json html_data(const Json& report, const codec::Comparison& comparison) {
  Json data{{"report", report},
            {"parts", parts_json(comparison)},
            {"size", comparison.size},
            {"skeleton", skeleton_json(comparison.skeleton)}};
  data["skin"] = comparison.triangles ? triangles_json(*comparison.triangles) : Json(nullptr);
  data["sets"] = Json::array();
  for (const gltf::ClipSetBytes& set : comparison.clip_sets) {
    Json targets = Json::array();
    for (const gltf::Target& target : set.targets)
      targets.push_back({target.node, path_names[static_cast<std::size_t>(target.path)]});
    data["sets"].push_back({{"targets", std::move(targets)}, {"stream", base64(set.stream)}});
  }
  KeyPacker keys;
  data["clips"] = Json::array();
  for (const codec::ComparedClip& clip : comparison.clips) {
    Json made{{"animation", clip.animation}, {"name", clip.name}};
    made["original"] = keys.pack(comparison.skeleton, clip.original);
    made["set"] = clip.clip_set;
    made["clip"] = clip.clip;
    // What is compressed the page decodes itself.
    made["other"] = keys.pack(comparison.skeleton, clip.beside);
    made["candidates"] = Json::array();
    for (const codec::Candidate& tried : clip.candidates)
      made["candidates"].push_back(
          {{"bytes", tried.bytes}, {"error", finite(tried.error)}, {"kept", tried.kept}, {"chosen", tried.chosen}});
    made["profile"] = profile_json(clip, comparison.skeleton.names);
    data["clips"].push_back(std::move(made));
  }
  data["keys"] = keys.json();
  return data;
}

}  // namespace nmc::report
