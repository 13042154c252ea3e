// Reads animation channels as curves, with the checks of glTF 2.0, section 3.11.
#include "gltf/animation_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "gltf/accessor.h"
#include "gltf/component.h"
#include "gltf/json_text.h"

namespace nmc::gltf {
namespace {

/// Floats in all curves together. Samplers can share accessors, so that a small file could ask for any number of
/// copies.
constexpr std::size_t most_floats = std::size_t{1} << 29;

/// The whole state of reading.
struct Reader {
  const Document& document;
  const TypedModel& typed;
  const std::vector<Node>& nodes;
  std::size_t floats = 0;
};

/// Why the document's channel cannot be a curve; empty when it can.
std::string reason_to_leave(const Json& animation, const Json& channel) {
  const Json& target = channel["target"];
  if (find(target, "extensions") != nullptr) return "its target has an extension, such as KHR_animation_pointer";
  if (find(target, "node") == nullptr) return "it targets no node";
  if (find(channel, "extensions") != nullptr) return "it has an extension";
  const Json& sampler = animation["samplers"][static_cast<std::size_t>(channel["sampler"].get<double>())];
  if (find(sampler, "extensions") != nullptr) return "its sampler has an extension";
  const std::string path = target["path"].get<std::string>();
  if (path != "translation" && path != "rotation" && path != "scale" && path != "weights") {
    return fmt::format("its path \"{}\" is not known", path);
  }
  const std::string interpolation = sampler.value("interpolation", std::string("LINEAR"));
  if (interpolation != "LINEAR" && interpolation != "STEP" && interpolation != "CUBICSPLINE") {
    return fmt::format("its interpolation \"{}\" is not known", interpolation);
  }
  return {};
}

Path to_path(const std::string& name) {
  if (name == "translation") return Path::translation;
  if (name == "rotation") return Path::rotation;
  return name == "scale" ? Path::scale : Path::weights;
}

Interpolation to_interpolation(const std::string& name) {
  if (name == "STEP") return Interpolation::step;
  return name == "CUBICSPLINE" ? Interpolation::cubic_spline : Interpolation::linear;
}

int width_of_path(Path path, const Node& node) {
  if (path == Path::weights) return static_cast<int>(node.weights.size());
  return path == Path::rotation ? 4 : 3;
}

void check_target(const Node& node, Path path, const Where& where) {
  if (path == Path::weights && node.weights.empty())
    where.fail("moves the weights of a node that has no morph targets");
  if (path != Path::weights && node.has_matrix) where.fail("moves a node that has a matrix");
}

void check_output_type(const tinygltf::Accessor& output, Path path, const Where& where) {
  const bool type_fits = path == Path::weights    ? output.type == TINYGLTF_TYPE_SCALAR
                         : path == Path::rotation ? output.type == TINYGLTF_TYPE_VEC4
                                                  : output.type == TINYGLTF_TYPE_VEC3;
  const bool may_be_integer = path == Path::weights || path == Path::rotation;
  const bool component_fits = output.componentType == float_32 || (may_be_integer && output.normalized);
  if (!type_fits || !component_fits) where.fail("has an output of a type that does not fit the channel's path");
}

std::vector<float> read_times(const Reader& reader, int accessor_index, Interpolation interpolation,
                              const Where& where) {
  const tinygltf::Accessor& accessor = reader.typed.model.accessors[static_cast<std::size_t>(accessor_index)];
  if (accessor.type != TINYGLTF_TYPE_SCALAR || accessor.componentType != float_32)
    where.fail("has an input that is not scalar floats");
  std::vector<float> times = read_floats(reader.typed.model, accessor_index, reader.document.name);
  if (times.front() < 0) where.fail(fmt::format("has a negative time, {}", times.front()));
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (!(times[i] > times[i - 1])) {
      where.fail(fmt::format("has times that do not increase at key {}: {} after {}", i, times[i], times[i - 1]));
    }
  }
  if (interpolation == Interpolation::cubic_spline && times.size() < 2)
    where.fail("has CUBICSPLINE interpolation with a single key");
  return times;
}

void check_rotations(const Curve& curve, const Where& where) {
  const std::size_t parts = curve.interpolation == Interpolation::cubic_spline ? 3 : 1;
  for (std::size_t key = 0; key < curve.times.size(); ++key) {
    const float* q = curve.values.data() + (key * parts + parts / 2) * 4;
    if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
      where.fail(fmt::format("has a rotation of zero length at key {}", key));
  }
}

bool has_equal_keys(const Curve& curve) {
  const auto width = static_cast<std::size_t>(curve.width);
  for (std::size_t i = width; i < curve.values.size(); ++i) {
    if (curve.values[i] != curve.values[i - width]) return false;
  }
  return true;
}

Curve read_curve(Reader& reader, const tinygltf::AnimationChannel& channel, const tinygltf::AnimationSampler& sampler,
                 const Where& where) {
  const tinygltf::Model& model = reader.typed.model;
  Curve curve;
  curve.node = channel.target_node;
  curve.path = to_path(channel.target_path);
  curve.interpolation = to_interpolation(sampler.interpolation);
  curve.width = width_of_path(curve.path, reader.nodes[static_cast<std::size_t>(curve.node)]);
  const tinygltf::Accessor& output = model.accessors[static_cast<std::size_t>(sampler.output)];
  check_output_type(output, curve.path, where);

  const std::size_t keys = model.accessors[static_cast<std::size_t>(sampler.input)].count;
  const std::size_t parts = curve.interpolation == Interpolation::cubic_spline ? 3 : 1;
  const std::size_t per_key = parts * (curve.path == Path::weights ? static_cast<std::size_t>(curve.width) : 1);
  if (output.count % per_key != 0 || output.count / per_key != keys) {
    where.fail(fmt::format("has {} output elements where its {} keys need {} each", output.count, keys, per_key));
  }
  reader.floats += keys + output.count * static_cast<std::size_t>(width_of(output));
  if (reader.floats > most_floats) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: the animations hold more than {} numbers.", reader.document.name, most_floats));
  }
  curve.times = read_times(reader, sampler.input, curve.interpolation, where);
  curve.values = read_floats(model, sampler.output, reader.document.name);
  if (curve.path == Path::rotation) check_rotations(curve, where);
  return curve;
}

AnimationSource read_animation(Reader& reader, std::size_t index) {
  const Json& json = reader.document.json["animations"][index];
  const tinygltf::Animation& animation = reader.typed.model.animations[index];
  const Where where{reader.document.name, fmt::format("animations[{}]", index)};
  AnimationSource source;
  source.name = animation.name.empty() ? fmt::format("#{}", index) : animation.name;
  std::map<int, const tinygltf::AnimationChannel*> typed_channels;
  const std::vector<int>& numbers = reader.typed.channel_numbers[index];
  for (std::size_t i = 0; i < numbers.size(); ++i) typed_channels[numbers[i]] = &animation.channels.at(i);

  std::set<std::pair<int, Path>> targets;
  const Json& channels = json["channels"];
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const int number = static_cast<int>(c);
    std::string reason = reason_to_leave(json, channels[c]);
    if (!reason.empty()) {
      source.untouched.push_back({number, std::move(reason), {}});
      continue;
    }
    const tinygltf::AnimationChannel& channel = *typed_channels.at(number);
    const Path path = to_path(channel.target_path);
    check_target(reader.nodes[static_cast<std::size_t>(channel.target_node)], path, where.at("channels", c));
    if (!targets.insert({channel.target_node, path}).second) {
      where.at("channels", c)
          .fail(fmt::format("moves the {} of node {}, as another channel does already", channel.target_path,
                            channel.target_node));
    }
    const auto sampler = static_cast<std::size_t>(channel.sampler);
    Curve curve = read_curve(reader, channel, animation.samplers.at(sampler), where.at("samplers", sampler));
    if (curve.interpolation == Interpolation::step && !has_equal_keys(curve)) {
      source.untouched.push_back({number, "its interpolation is STEP", std::move(curve)});
    } else {
      source.channels.push_back({number, channel.sampler, std::move(curve)});
    }
  }
  return source;
}

}  // namespace

std::vector<AnimationSource> read_animations(const Document& document, const TypedModel& typed,
                                             const std::vector<Node>& nodes) {
  Reader reader{document, typed, nodes};
  std::vector<AnimationSource> animations;
  for (std::size_t i = 0; i < typed.model.animations.size(); ++i) animations.push_back(read_animation(reader, i));
  return animations;
}

}  // namespace nmc::gltf
