// Files that are missing, broken or hostile: the right exit code, a sentence that says what is wrong, nothing left
// behind.
#include <limits>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

constexpr int cannot_access = 2;
constexpr int invalid_input = 3;
constexpr int unsupported = 4;

std::string accessor(std::size_t index) { return "accessors[" + std::to_string(index) + "]"; }

class BadInput : public CommandLine {
 protected:
  void expect_invalid(const Bytes& bytes, const std::vector<std::string>& parts) {
    expect_failure({input("in.glb", bytes), file("out.glb")}, invalid_input, parts);
  }
};

TEST_F(BadInput, MissingFile) { expect_failure({file("absent.glb"), file("out.glb")}, cannot_access, {"absent.glb"}); }

TEST_F(BadInput, FolderAsInput) { expect_failure({folder_.path(), file("out.glb")}, cannot_access, {"folder"}); }

TEST_F(BadInput, ZeroBytes) { expect_invalid({}, {"in.glb"}); }

TEST_F(BadInput, Garbage) {
  Bytes bytes(5000);
  std::uint32_t state = 12345;
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24);
  expect_invalid(bytes, {"in.glb"});
}

TEST_F(BadInput, TruncatedGlb) {
  const Bytes whole = TinyGlb(3).bytes();
  for (std::size_t length = 1; length < whole.size(); length += whole.size() / 23) {
    expect_invalid(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)), {"in.glb"});
  }
}

TEST_F(BadInput, WrongLengthField) {
  Bytes bytes = TinyGlb().bytes();
  bytes[10] = 0xff;
  expect_invalid(bytes, {"in.glb"});
}

TEST_F(BadInput, WrongChunkLength) {
  Bytes bytes = TinyGlb().bytes();
  bytes[15] = 0xff;  // the highest byte of the JSON chunk's length
  expect_invalid(bytes, {"in.glb"});
}

TEST_F(BadInput, VersionOne) {
  TinyGlb tiny;
  tiny.json["asset"]["version"] = "1.0";
  expect_failure({input("in.glb", tiny.bytes()), file("out.glb")}, unsupported, {"in.glb", "glTF 1"});
}

TEST_F(BadInput, DeepJson) {
  const std::string json = R"({"asset":{"version":"2.0"},"extras":)" + std::string(2'000'000, '[');
  expect_failure({input("in.gltf", Bytes(json.begin(), json.end())), file("out.glb")}, unsupported, {"in.gltf"});
}

TEST_F(BadInput, AccessorOutOfRange) {
  TinyGlb tiny;
  tiny.json["accessors"][tiny.root_rotation]["count"] = 1'000'000;
  expect_invalid(tiny.bytes(), {"in.glb", accessor(tiny.root_rotation)});
}

TEST_F(BadInput, AccessorOffsetThatOverflows) {
  TinyGlb tiny;
  tiny.json["accessors"][tiny.root_rotation]["byteOffset"] = 18446744073709551600ULL;
  expect_invalid(tiny.bytes(), {"in.glb", accessor(tiny.root_rotation)});
}

TEST_F(BadInput, SamplerWithoutAccessor) {
  TinyGlb tiny;
  tiny.json["animations"][0]["samplers"][0]["output"] = 999;
  expect_invalid(tiny.bytes(), {"in.glb", "animations[0]"});
}

TEST_F(BadInput, ChannelOnNoNode) {
  TinyGlb tiny;
  tiny.json["animations"][0]["channels"][0]["target"]["node"] = 77;
  expect_invalid(tiny.bytes(), {"in.glb", "animations[0]"});
}

/// glTF 2.0, animation.schema.json: channels and samplers hold at least one item.
TEST_F(BadInput, AnimationWithoutChannels) {
  TinyGlb tiny;
  tiny.json["animations"].push_back({{"name", "nothing"}, {"channels", Json::array()}, {"samplers", Json::array()}});
  expect_invalid(tiny.bytes(), {"in.glb", "animations[1]"});
}

TEST_F(BadInput, NodeCycle) {
  TinyGlb tiny;
  tiny.json["nodes"][1]["children"] = {0};
  expect_invalid(tiny.bytes(), {"in.glb", "nodes["});
}

TEST_F(BadInput, NanKeys) {
  TinyGlb tiny;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(tiny.bin.data() + tiny.offset_of(tiny.root_rotation) + 64, &nan, sizeof nan);
  expect_invalid(tiny.bytes(), {"in.glb", accessor(tiny.root_rotation)});
}

TEST_F(BadInput, TimesThatGoBack) {
  TinyGlb tiny;
  const float late = 100;
  std::memcpy(tiny.bin.data() + tiny.offset_of(tiny.times) + 8, &late, sizeof late);
  expect_invalid(tiny.bytes(), {"in.glb"});
}

TEST_F(BadInput, OutputFolderMissing) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  expect_failure({in, file("no/such/out.glb")}, cannot_access, {"out.glb", "no/such"});
}

TEST_F(BadInput, OutputIsAFolder) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const ScratchFolder other;
  std::filesystem::create_directory(other.path() / "out.glb");
  expect_failure({in, other.file("out.glb")}, cannot_access, {"out.glb", "folder"});
  EXPECT_TRUE(std::filesystem::is_directory(other.path() / "out.glb"));
}

TEST_F(BadInput, OtherCommandsSayTheSame) {
  const std::string broken = input("broken.glb", {1, 2, 3, 4, 5});
  const std::string good = input("good.glb", TinyGlb(3).bytes());
  expect_failure({"decode", file("absent.glb"), file("out.glb")}, cannot_access, {"absent.glb"});
  expect_failure({"decode", broken, file("out.glb")}, invalid_input, {"broken.glb"});
  expect_failure({"decode", good, file("no/such/out.glb")}, cannot_access, {"out.glb"});
  expect_failure({"inspect", file("absent.glb")}, cannot_access, {"absent.glb"});
  expect_failure({"inspect", broken}, invalid_input, {"broken.glb"});
  expect_failure({"verify", good, file("absent.glb")}, cannot_access, {"absent.glb"});
  expect_failure({"verify", broken, good}, invalid_input, {"broken.glb"});
}

TEST_F(BadInput, VerifyOfAnotherCharacter) {
  TinyGlb other(3);
  other.json["nodes"].push_back({{"name", "third"}});
  const std::string a = input("a.glb", TinyGlb(3).bytes());
  const std::string b = input("b.glb", other.bytes());
  expect_failure({"verify", a, b}, invalid_input, {"node"});
}

TEST_F(BadInput, CompressedStreamWithAFlippedBit) {
  const ScratchFolder other;
  const std::string packed = other.file("packed.glb");
  run_well({input("in.glb", TinyGlb().bytes()), packed, "--tolerance", "1%"});
  GlbParts parts = split_glb(read_bytes(packed));
  ASSERT_TRUE(parts.json.contains("extensions"));
  const Json& set = parts.json["extensions"]["NMC_animation_compression"]["clipSets"][0];
  const Json& view = parts.json["bufferViews"][set["bufferView"].get<std::size_t>()];
  parts.bin[view.value("byteOffset", std::size_t{0}) + view["byteLength"].get<std::size_t>() / 2] ^= 0x10;
  const std::string flipped = input("flipped.glb", make_glb(parts.json, parts.bin));
  expect_failure({"decode", flipped, file("out.glb")}, invalid_input, {"flipped.glb"});
  expect_failure({"inspect", flipped}, invalid_input, {"flipped.glb"});
}

}  // namespace
}  // namespace nmc::test
