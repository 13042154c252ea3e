// The sample characters as a reader of their bytes sees them.
#include "samples/characters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "samples/humanoid.h"

namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;
using Row = std::vector<double>;
using namespace nmc::samples;

std::uint32_t u32_at(const Bytes& bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, 4);
  return value;
}

/// A GLB taken apart by the glTF specification's section 4, sharing nothing with the writer.
struct File {
  Json json;
  Bytes binary;
};

File take_apart(const Bytes& bytes) {
  const std::size_t json_size = u32_at(bytes, 12);
  const char* text = reinterpret_cast<const char*>(bytes.data()) + 20;
  return {Json::parse(text, text + json_size), Bytes(bytes.begin() + static_cast<long>(28 + json_size), bytes.end())};
}

const File& file_named(const std::string& name) {
  static std::map<std::string, File> cache;
  if (!cache.contains(name)) cache[name] = take_apart(make_character(name));
  return cache[name];
}

double component_at(const Bytes& binary, std::size_t offset, int type) {
  if (type == 5121) return binary.at(offset);
  if (type == 5123) return binary.at(offset) + 256.0 * binary.at(offset + 1);
  float value = 0.0f;
  std::memcpy(&value, binary.data() + offset, 4);
  return value;
}

/// Rows `first` .. of an accessor, all of them when `count` is 0.
std::vector<Row> read_accessor(const File& file, const Json& index, std::size_t first = 0, std::size_t count = 0) {
  static const std::map<std::string, std::size_t> widths = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  const Json& accessor = file.json["accessors"].at(index.get<std::size_t>());
  const Json& view = file.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
  const int type = accessor["componentType"];
  const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : 4, width = widths.at(accessor["type"]);
  const std::size_t start = view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  const double scale = accessor.value("normalized", false) ? (type == 5121 ? 255.0 : 65535.0) : 1.0;
  std::vector<Row> rows(count == 0 ? accessor["count"].get<std::size_t>() : count, Row(width));
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < width; ++c)
      rows[r][c] = component_at(file.binary, start + ((first + r) * width + c) * size, type) / scale;
  return rows;
}

const Json& animation_named(const File& file, const std::string& name) {
  for (const Json& animation : file.json["animations"]) {
    if (animation["name"] == name) return animation;
  }
  throw std::out_of_range("no animation " + name);
}

std::size_t node_named(const File& file, const std::string& name) {
  for (std::size_t i = 0; i < file.json["nodes"].size(); ++i) {
    if (file.json["nodes"][i].value("name", "") == name) return i;
  }
  throw std::out_of_range("no node " + name);
}

glm::dmat4 local_matrix(const Row& t, const Row& r, const Row& s) {
  glm::dmat4 m = glm::mat4_cast(glm::dquat(r[3], r[0], r[1], r[2]));
  for (int i = 0; i < 3; ++i) m[i] *= s[static_cast<std::size_t>(i)];
  m[3] = glm::dvec4(t[0], t[1], t[2], 1.0);
  return m;
}

/// World matrices of all nodes at a key of an animation whose samplers share their times; "" is the rest pose. Parents
/// precede children in the samples.
std::vector<glm::dmat4> world_matrices(const File& file, const std::string& animation, std::size_t key) {
  std::vector<std::map<std::string, Row>> values;
  for (const Json& node : file.json["nodes"]) {
    values.push_back({{"translation", node.value("translation", Row{0, 0, 0})},
                      {"rotation", node.value("rotation", Row{0, 0, 0, 1})},
                      {"scale", node.value("scale", Row{1, 1, 1})}});
  }
  if (!animation.empty()) {
    const Json& a = animation_named(file, animation);
    for (const Json& channel : a["channels"]) {
      const Json& sampler = a["samplers"][channel["sampler"].get<std::size_t>()];
      values[channel["target"]["node"].get<std::size_t>()][channel["target"]["path"]] =
          read_accessor(file, sampler["output"], key, 1).front();
    }
  }
  std::vector<glm::dmat4> world(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    world[i] = local_matrix(values[i]["translation"], values[i]["rotation"], values[i]["scale"]);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (const Json& child : file.json["nodes"][i].value("children", Json::array())) {
      world[child.get<std::size_t>()] = world[i] * world[child.get<std::size_t>()];
    }
  }
  return world;
}

const std::vector<std::string> skinned_files = {"humanoid_30hz.glb", "humanoid_120hz.glb", "humanoid_all_channels.glb",
                                                "quadruped_30hz.glb"};

TEST(Characters, UnknownNameIsRefused) { EXPECT_THROW(make_character("nobody.glb"), std::invalid_argument); }

TEST(Characters, SameBytesOnEveryCall) {
  for (const CharacterInfo& info : list_characters()) {
    EXPECT_EQ(make_character(info.file_name), make_character(info.file_name)) << info.file_name;
  }
}

TEST(Characters, ContainersAreWellFormed) {
  for (const CharacterInfo& info : list_characters()) {
    SCOPED_TRACE(info.file_name);
    const Bytes bytes = make_character(info.file_name);
    const std::size_t json_size = u32_at(bytes, 12);
    EXPECT_EQ(u32_at(bytes, 0), 0x46546C67u);
    EXPECT_EQ(u32_at(bytes, 4), 2u);
    EXPECT_EQ(u32_at(bytes, 8), bytes.size());
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(u32_at(bytes, 20 + json_size), bytes.size() - 28 - json_size);
    const File file = take_apart(bytes);
    EXPECT_LE(file.binary.size() - file.json["buffers"][0]["byteLength"].get<std::size_t>(), 3u);
    for (const Json& view : file.json["bufferViews"]) {
      EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), file.binary.size());
    }
  }
}

TEST(Characters, JointCounts) {
  EXPECT_EQ(file_named("humanoid_30hz.glb").json["skins"][0]["joints"].size(), 52u);
  EXPECT_EQ(file_named("quadruped_30hz.glb").json["skins"][0]["joints"].size(), 38u);
}

TEST(Characters, SkinWeightsSumToOneAndNameJoints) {
  for (const std::string& name : skinned_files) {
    SCOPED_TRACE(name);
    const File& file = file_named(name);
    const Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    const auto weights = read_accessor(file, attributes["WEIGHTS_0"]),
               joints = read_accessor(file, attributes["JOINTS_0"]);
    ASSERT_GT(weights.size(), 5000u);
    double worst = 0.0, highest_joint = 0.0;
    for (std::size_t v = 0; v < weights.size(); ++v) {
      worst = std::max(worst, std::abs(weights[v][0] + weights[v][1] + weights[v][2] + weights[v][3] - 1.0));
      highest_joint = std::max(highest_joint, *std::max_element(joints[v].begin(), joints[v].end()));
    }
    EXPECT_LT(worst, 1e-6);
    EXPECT_LT(highest_joint, static_cast<double>(file.json["skins"][0]["joints"].size()));
  }
}

TEST(Characters, InverseBindMatricesUndoTheRestPose) {
  for (const std::string& name : skinned_files) {
    SCOPED_TRACE(name);
    const File& file = file_named(name);
    const auto world = world_matrices(file, "", 0);
    const auto inverse = read_accessor(file, file.json["skins"][0]["inverseBindMatrices"]);
    double worst = 0.0;
    for (std::size_t j = 0; j < inverse.size(); ++j) {
      glm::dmat4 bind;
      for (int i = 0; i < 16; ++i) bind[i / 4][i % 4] = inverse[j][static_cast<std::size_t>(i)];
      const glm::dmat4 product = world[file.json["skins"][0]["joints"][j].get<std::size_t>()] * bind;
      for (int i = 0; i < 16; ++i)
        worst = std::max(worst, std::abs(product[i / 4][i % 4] - (i / 4 == i % 4 ? 1.0 : 0.0)));
    }
    EXPECT_LT(worst, 1e-5);
  }
}

TEST(Characters, RotationsAreUnitAndNeighboursLieOnOneSide) {
  for (const std::string& name : skinned_files) {
    SCOPED_TRACE(name);
    const File& file = file_named(name);
    double worst = 0.0, smallest_dot = 1.0;
    for (const Json& animation : file.json["animations"])
      for (const Json& channel : animation["channels"]) {
        if (channel["target"]["path"] != "rotation") continue;
        const auto keys = read_accessor(file, animation["samplers"][channel["sampler"].get<std::size_t>()]["output"]);
        for (std::size_t k = 0; k < keys.size(); ++k) {
          double square = 0.0, dot = 0.0;
          for (std::size_t i = 0; i < 4; ++i)
            square += keys[k][i] * keys[k][i], dot += keys[k][i] * keys[k > 0 ? k - 1 : 0][i];
          worst = std::max(worst, std::abs(square - 1.0));
          smallest_dot = std::min(smallest_dot, dot);
        }
      }
    EXPECT_LT(worst, 1e-6);
    EXPECT_GT(smallest_dot, 0.5);
  }
}

TEST(Characters, KeyTimesAreFramesOverRateInFloat) {
  for (const std::string& name : skinned_files) {
    SCOPED_TRACE(name);
    const File& file = file_named(name);
    const double rate = name == "humanoid_120hz.glb" ? 120.0 : 30.0;
    for (const Json& animation : file.json["animations"])
      for (const Json& sampler : animation["samplers"]) {
        EXPECT_EQ(sampler["interpolation"], "LINEAR");
        const auto times = read_accessor(file, sampler["input"]);
        for (std::size_t i = 0; i < times.size(); ++i) {
          ASSERT_EQ(static_cast<float>(times[i][0]), static_cast<float>(static_cast<double>(i) / rate));
        }
      }
  }
}

TEST(Characters, LoopsClose) {
  const std::map<std::string, std::vector<std::string>> loops = {
      {"humanoid_30hz.glb", {"walk", "run", "idle"}},
      {"humanoid_120hz.glb", {"walk", "idle"}},
      {"quadruped_30hz.glb", {"walk", "trot", "gallop", "idle"}}};
  for (const auto& [name, clips] : loops)
    for (const std::string& clip : clips) {
      SCOPED_TRACE(name + " " + clip);
      const File& file = file_named(name);
      const Json& animation = animation_named(file, clip);
      double gap = 0.0, motion = 0.0;
      for (const Json& sampler : animation["samplers"]) {
        const auto keys = read_accessor(file, sampler["output"]);
        for (std::size_t i = 0; i < keys[0].size(); ++i) {
          gap = std::max(gap, std::abs(keys.front()[i] - keys.back()[i]));
          motion = std::max(motion, std::abs(keys.front()[i] - keys[keys.size() / 3][i]));
        }
      }
      EXPECT_LT(gap, 1e-6);
      EXPECT_GT(motion, 0.01);
    }
}

TEST(Characters, SpinTurnsMoreThanOnce) {
  const File& file = file_named("humanoid_30hz.glb");
  const std::size_t hips = node_named(file, "hips"), keys = 97;
  double turned = 0.0;
  glm::dvec3 last(0, 0, 1);
  for (std::size_t k = 0; k < keys; ++k) {
    const glm::dmat3 turn = glm::dmat3(world_matrices(file, "spin", k)[hips]) *
                            glm::transpose(glm::dmat3(world_matrices(file, "", 0)[hips]));
    const glm::dvec3 front = turn * glm::dvec3(0, 0, 1);
    turned += std::atan2(last.z * front.x - last.x * front.z, last.z * front.z + last.x * front.x);
    last = front;
  }
  EXPECT_NEAR(turned, 4.0 * 3.14159265358979, 0.05);
}

TEST(Characters, StandingFeetStayWhereTheyAre) {
  const File& file = file_named("humanoid_30hz.glb");
  const std::array<std::size_t, 2> balls = {node_named(file, "toes_l"), node_named(file, "toes_r")};
  for (const std::string clip : {"walk_root_motion", "run_root_motion"}) {
    SCOPED_TRACE(clip);
    const std::vector<Contact> contacts = humanoid_contacts(clip);
    ASSERT_GE(contacts.size(), 6u);
    for (const Contact& contact : contacts) {
      glm::dvec3 low(1e9), high(-1e9);
      int keys = 0;
      for (int k = static_cast<int>(std::ceil(contact.from_seconds * 30.0 - 1e-9));
           k <= contact.to_seconds * 30.0 + 1e-9; ++k, ++keys) {
        const glm::dvec3 at(
            world_matrices(file, clip, static_cast<std::size_t>(k))[balls[static_cast<std::size_t>(contact.foot)]][3]);
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
      if (keys == 0) continue;
      EXPECT_LT(glm::length(high - low), 0.002) << "foot " << contact.foot << " from " << contact.from_seconds;
      EXPECT_NEAR(low.y, 0.02, 0.001);
    }
  }
}

TEST(Characters, RootMotionMovesForward) {
  const File& file = file_named("humanoid_30hz.glb");
  const std::size_t hips = node_named(file, "hips");
  const double walked =
      world_matrices(file, "walk_root_motion", 96)[hips][3].z - world_matrices(file, "walk_root_motion", 0)[hips][3].z;
  const double ran =
      world_matrices(file, "run_root_motion", 63)[hips][3].z - world_matrices(file, "run_root_motion", 0)[hips][3].z;
  EXPECT_NEAR(walked, 3.2 * 1.12, 0.01);
  EXPECT_NEAR(ran, 2.1 * 3.1, 0.01);
}

TEST(Characters, KneesBendForwardsOnly) {
  const File& file = file_named("humanoid_30hz.glb");
  for (const std::string clip : {"walk", "run", "jump", "wave"})
    for (const std::string side : {"_l", "_r"}) {
      SCOPED_TRACE(clip + side);
      const std::size_t hip = node_named(file, "thigh" + side), knee = node_named(file, "shin" + side),
                        ankle = node_named(file, "foot" + side);
      for (std::size_t k = 0; k < 22; ++k) {
        const auto world = world_matrices(file, clip, k);
        const glm::dvec3 upper(world[knee][3] - world[hip][3]), lower(world[ankle][3] - world[knee][3]);
        ASSERT_GT(glm::cross(upper, lower).x, 0.0) << "key " << k;
      }
    }
}

TEST(Characters, HalfTurnRigHasRestRotationsNearPi) {
  const File& file = file_named("humanoid_all_channels.glb");
  for (const Json& joint : file.json["skins"][0]["joints"]) {
    const Json& node = file.json["nodes"][joint.get<std::size_t>()];
    EXPECT_LT(std::abs(node["rotation"][3].get<double>()), std::sin(0.05 + 1e-3)) << node["name"];
  }
  for (const Json& animation : file.json["animations"]) EXPECT_EQ(animation["channels"].size(), 3u * 52u);
}

TEST(Characters, PropsHoldWhatTheyPromise) {
  const File& file = file_named("props.glb");
  std::map<std::string, int> interpolations, paths;
  for (const Json& animation : file.json["animations"]) {
    for (const Json& sampler : animation["samplers"]) ++interpolations[sampler["interpolation"]];
    for (const Json& channel : animation["channels"]) ++paths[channel["target"]["path"]];
  }
  EXPECT_GT(interpolations["CUBICSPLINE"], 0);
  EXPECT_GT(interpolations["STEP"], 0);
  EXPECT_GT(paths["weights"], 0);
  EXPECT_GT(paths["scale"], 0);
  const Json& late = file.json["animations"].back();
  EXPECT_GT(read_accessor(file, late["samplers"][0]["input"]).front()[0], 0.5);
  const Json& image = file.json["bufferViews"][file.json["images"][0]["bufferView"].get<std::size_t>()];
  const std::vector<std::uint8_t> signature = {0x89, 'P', 'N', 'G'};
  EXPECT_TRUE(std::equal(signature.begin(), signature.end(), file.binary.begin() + image["byteOffset"].get<long>()));
  EXPECT_EQ(file_named("unknown_extension.glb").json["extensionsUsed"][0], "EXAMPLE_unknown");
}

}  // namespace
