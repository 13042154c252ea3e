// Our error against the referee's: a small skinned character is written as glTF twice, once wrong, and measured by
// both.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "motion/error.h"

namespace nmc::motion {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* python = "/usr/bin/python3";
constexpr int joints = 9;
constexpr int vertices = 600;  // fewer than the referee thins out

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double gauss() { return normal_(engine_); }
  float small(double scale) { return static_cast<float>(scale * gauss()); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

/// A character as it is in a glTF file: float data.
struct Character {
  Skeleton skeleton;
  std::vector<std::array<float, 16>> inverse_bind;
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint16_t, 4>> vertex_joints;
  std::vector<std::array<float, 4>> weights;
};

Transform random_rest(Random& random) {
  const auto whole = [&](double scale) { return static_cast<double>(random.small(scale)); };
  Transform t;
  t.translation = {whole(0.3), whole(0.3), whole(0.3)};
  // Float quaternions a little off unit length are not the point here: half turns about the axes are exact.
  t.rotation = random.gauss() > 0 ? glm::dquat(1, 0, 0, 0) : glm::dquat(0, 0, 1, 0);
  t.scale = {1.0, random.gauss() > 0 ? 1.0 : 1.25, 1.0};
  return t;
}

Character make_character() {
  Random random(1);
  Character c;
  Skeleton& s = c.skeleton;
  for (int j = 0; j < joints; ++j) {
    s.names.push_back("joint" + std::to_string(j));
    s.parent.push_back(j == 0 ? -1 : (j - 1) / 2);
    s.order.push_back(j);
    s.rest.push_back(random_rest(random));
    s.rest_matrix.push_back(to_matrix(s.rest.back()));
    s.rest_weights.emplace_back();
    s.joints.push_back(j);
    std::array<float, 16> bind{};
    for (std::size_t k = 0; k < 16; ++k) bind[k] = k % 5 == 0 ? 1.0f : (k % 4 == 3 ? 0.0f : random.small(0.1));
    c.inverse_bind.push_back(bind);
  }
  for (int v = 0; v < vertices; ++v) {
    c.positions.push_back({random.small(0.5), random.small(0.5), random.small(0.5)});
    const auto joint = [&](int k) { return static_cast<std::uint16_t>((v + k) % joints); };
    c.vertex_joints.push_back({joint(0), joint(1), joint(3), joint(4)});
    c.weights.push_back({0.5f, 0.25f, 0.25f, 0.0f});
  }
  return c;
}

Points points_of(const Character& c) {
  Points points;
  for (const int joint : c.skeleton.joints) {
    const Influence origin{joint, {0, 0, 0}, 1.0};
    points.add(&origin, &origin + 1);
  }
  for (std::size_t v = 0; v < c.positions.size(); ++v) {
    std::array<Influence, 4> influences;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::array<float, 16>& m = c.inverse_bind[c.vertex_joints[v][k]];
      Influence& influence = influences[k];
      influence.node = c.vertex_joints[v][k];
      influence.weight = c.weights[v][k];
      for (std::size_t r = 0; r < 3; ++r) {
        influence.offset[r] = m[12 + r];
        for (std::size_t i = 0; i < 3; ++i)
          influence.offset[r] += static_cast<double>(m[4 * i + r]) * c.positions[v][i];
      }
    }
    points.add(influences.data(), influences.data() + influences.size());
  }
  return points;
}

/// An animation of every kind of curve; `wrong` is the size of the mistakes in it.
Animation make_animation(double wrong) {
  Random random(2), mistakes(3);
  Animation animation{"dance", {}};
  const auto value = [&](double scale) {
    return static_cast<float>(scale * random.gauss() + wrong * mistakes.gauss());
  };
  for (int j = 0; j < joints; ++j) {
    for (const Path path : {Path::translation, Path::rotation, Path::scale}) {
      if ((j + static_cast<int>(path)) % 4 == 3) continue;
      const Interpolation mode = static_cast<Interpolation>((j + static_cast<int>(path)) % 3);
      Curve curve{j, path, mode, path == Path::rotation ? 4 : 3, {}, {}};
      const int keys = 3 + j;
      for (int k = 0; k < keys; ++k)
        curve.times.push_back(0.125f * static_cast<float>(j % 3) + static_cast<float>(k) / 7);
      const std::size_t rows = static_cast<std::size_t>(keys) * (mode == Interpolation::cubic_spline ? 3 : 1);
      for (std::size_t i = 0; i < rows * static_cast<std::size_t>(curve.width); ++i) {
        curve.values.push_back(path == Path::scale ? 1.0f + value(0.05) : value(0.5));
      }
      animation.curves.push_back(std::move(curve));
    }
  }
  return animation;
}

/// Collects accessors and their bytes.
class Writer {
 public:
  template <typename T>
  std::size_t add(const std::vector<T>& rows, const char* type, int component_type, std::size_t count) {
    const std::size_t bytes = rows.size() * sizeof(T), offset = data_.size();
    data_.resize(offset + bytes);
    std::memcpy(data_.data() + offset, rows.data(), bytes);
    views_.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return accessors_.size() - 1;
  }

  void write(const fs::path& path, json document) const {
    const fs::path data_path = fs::path(path).replace_extension(".bin");
    document["asset"] = {{"version", "2.0"}};
    document["buffers"] = {{{"byteLength", data_.size()}, {"uri", data_path.filename().string()}}};
    document["bufferViews"] = views_;
    document["accessors"] = accessors_;
    std::ofstream(data_path, std::ios::binary).write(data_.data(), static_cast<std::streamsize>(data_.size()));
    std::ofstream(path) << document;
  }

 private:
  std::vector<char> data_;
  json views_ = json::array(), accessors_ = json::array();
};

json nodes_of(const Skeleton& s) {
  json nodes = json::array();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Transform& t = s.rest[i];
    nodes.push_back({{"name", s.names[i]},
                     {"translation", {t.translation.x, t.translation.y, t.translation.z}},
                     {"rotation", {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w}},
                     {"scale", {t.scale.x, t.scale.y, t.scale.z}}});
    for (std::size_t child = 0; child < s.size(); ++child) {
      if (s.parent[child] == static_cast<int>(i)) nodes.back()["children"].push_back(child);
    }
  }
  nodes.push_back({{"name", "skin"}, {"mesh", 0}, {"skin", 0}});
  return nodes;
}

void write_gltf(const fs::path& path, const Character& c, const Animation& animation) {
  constexpr int float_type = 5126, short_type = 5123;
  Writer writer;
  json document;
  document["nodes"] = nodes_of(c.skeleton);
  document["skins"] = {
      {{"joints", c.skeleton.joints}, {"inverseBindMatrices", writer.add(c.inverse_bind, "MAT4", float_type, joints)}}};
  const json attributes = {{"POSITION", writer.add(c.positions, "VEC3", float_type, vertices)},
                           {"JOINTS_0", writer.add(c.vertex_joints, "VEC4", short_type, vertices)},
                           {"WEIGHTS_0", writer.add(c.weights, "VEC4", float_type, vertices)}};
  document["meshes"] = {{{"primitives", {{{"attributes", attributes}}}}}};
  json samplers = json::array(), channels = json::array();
  for (const Curve& curve : animation.curves) {
    constexpr std::array paths{"translation", "rotation", "scale"};
    constexpr std::array modes{"LINEAR", "STEP", "CUBICSPLINE"};
    const std::size_t rows = curve.values.size() / static_cast<std::size_t>(curve.width);
    channels.push_back({{"sampler", samplers.size()},
                        {"target", {{"node", curve.node}, {"path", paths[static_cast<std::size_t>(curve.path)]}}}});
    samplers.push_back({{"input", writer.add(curve.times, "SCALAR", float_type, curve.times.size())},
                        {"output", writer.add(curve.values, curve.width == 4 ? "VEC4" : "VEC3", float_type, rows)},
                        {"interpolation", modes[static_cast<std::size_t>(curve.interpolation)]}});
  }
  document["animations"] = {{{"name", animation.name}, {"samplers", samplers}, {"channels", channels}}};
  writer.write(path, document);
}

json run_referee(const fs::path& script, const fs::path& original, const fs::path& decoded) {
  const fs::path report = original.parent_path() / "report.json";
  const std::string command = std::string(python) + " '" + script.string() + "' --json '" + original.string() + "' '" +
                              decoded.string() + "' > '" + report.string() + "'";
  if (std::system(command.c_str()) != 0) return {};
  std::stringstream text;
  text << std::ifstream(report).rdbuf();
  return json::parse(text.str());
}

TEST(Referee, MeasuresTheSame) {
  const fs::path script = fs::path(NMC_SHARED_DIR) / "tools" / "measure.py";
  if (!fs::exists(script)) GTEST_SKIP() << "the referee is not here: " << script;
  if (!fs::exists(python)) GTEST_SKIP() << "no " << python;
  const fs::path folder = fs::path(NMC_BUILD_DIR) / "referee_test";
  fs::create_directories(folder);

  const Character character = make_character();
  const Points points = points_of(character);
  const Animation original = make_animation(0.0);
  write_gltf(folder / "original.gltf", character, original);
  for (const double wrong : {1e-4, 0.01, 0.3}) {
    const Animation decoded = make_animation(wrong);
    write_gltf(folder / "decoded.gltf", character, decoded);
    const json report = run_referee(script, folder / "original.gltf", folder / "decoded.gltf");
    ASSERT_TRUE(report.contains("overall")) << "the referee failed";
    const ErrorReport ours = measure_error(character.skeleton, points, original, decoded);
    const double size = report["size"];
    EXPECT_NEAR(character_size(character.skeleton, points), size, 1e-6 * size);
    const json& overall = report["overall"];
    const double joint = overall["joint"]["max"], vertex = overall["vertex"]["max"], degrees = overall["rot"]["max"];
    EXPECT_NEAR(ours.max_joint, joint, 1e-6 * size);
    EXPECT_NEAR(ours.max, std::max(joint, vertex), 1e-6 * size);
    EXPECT_NEAR(ours.max_rotation_degrees, degrees, 1e-6);
  }
}

}  // namespace
}  // namespace nmc::motion
