// Reading and writing documents: containers, URIs, errors, round trips.
#include "gltf/document.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace {

namespace fs = std::filesystem;
using nmc::ErrorCode;
using nmc::gltf::Bytes;
using nmc::gltf::Document;
using nmc::gltf::Json;
using testing::HasSubstr;

/// A folder of one test that goes away with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "nmc_document_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { fs::remove_all(path_); }
  fs::path operator/(const char* name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void write_bytes(const fs::path& path, std::string_view bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::string read_bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string u32(std::uint32_t value) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(value >> shift & 255));
  return out;
}

std::string chunk(std::string_view type, std::string_view data) {
  return u32(static_cast<std::uint32_t>(data.size())) + std::string(type) + std::string(data);
}

std::string glb(const std::string& chunks, std::uint32_t version = 2) {
  return "glTF" + u32(version) + u32(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

const std::string bin_type{"BIN\0", 4};

std::string padded(std::string text) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return text;
}

const std::string asset_json = padded(R"({"asset":{"version":"2.0"}})");
const std::string buffer_json = padded(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":6}]})");

Document parse(std::string_view bytes, const std::string& name, const fs::path& folder = "/nowhere") {
  return nmc::gltf::parse_document({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name, folder);
}

/// Calls and returns the Error, which must come.
template <typename Call>
nmc::Error error_of(Call call) {
  try {
    call();
  } catch (const nmc::Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error was thrown";
  return {ErrorCode::internal, ""};
}

void expect_error(std::string_view bytes, const std::string& name, ErrorCode code, const std::string& words) {
  const nmc::Error error = error_of([&] { parse(bytes, name); });
  EXPECT_EQ(error.code(), code) << error.what();
  EXPECT_THAT(error.what(), HasSubstr(words));
  EXPECT_THAT(error.what(), HasSubstr(name));
}

TEST(Document, ReadsGlbWithBufferOfExactLength) {
  const Document document = parse(glb(chunk("JSON", buffer_json) + chunk(bin_type, "abcdefgh")), "a.glb");
  EXPECT_TRUE(document.is_glb);
  ASSERT_EQ(document.buffers.size(), 1u);
  EXPECT_EQ(document.buffers[0], (Bytes{'a', 'b', 'c', 'd', 'e', 'f'}));
  EXPECT_TRUE(document.has_data[0]);
}

TEST(Document, NamesWhatIsWrongWithAContainer) {
  const std::string json = chunk("JSON", asset_json);
  expect_error("", "a.glb", ErrorCode::invalid_input, "empty");
  expect_error("g", "a.glb", ErrorCode::invalid_input, "ends after 1 bytes");
  expect_error("PNG and more bytes", "a.glb", ErrorCode::invalid_input, "letters glTF");
  expect_error("PNG and more bytes", "a.bin", ErrorCode::invalid_input, "neither a GLB file nor glTF JSON");
  expect_error(glb(json, 1), "a.glb", ErrorCode::unsupported, "glTF 1");
  expect_error(glb(json, 0), "a.glb", ErrorCode::invalid_input, "version is 0");
  expect_error(glb(""), "a.glb", ErrorCode::invalid_input, "too small");
  expect_error(glb(json).substr(0, 30), "a.glb", ErrorCode::invalid_input, "truncated after 30");
  expect_error(glb(json + "abcd"), "a.glb", ErrorCode::invalid_input, "header of chunk 1");
  expect_error(glb(u32(0xFFFFFFFF) + "JSON" + asset_json), "a.glb", ErrorCode::invalid_input,
               "chunk 0 of 4294967295 bytes is truncated");
  expect_error(glb(chunk("JSON", asset_json + "  ")), "a.glb", ErrorCode::invalid_input, "not aligned");
  expect_error(glb(chunk("JSON", "")), "a.glb", ErrorCode::invalid_input, "JSON chunk is empty");
  expect_error(glb(chunk(bin_type, "abcd") + json), "a.glb", ErrorCode::invalid_input, "first chunk is not the JSON");
  expect_error(glb(json + json), "a.glb", ErrorCode::invalid_input, "duplicate JSON");
  expect_error(glb(json + chunk(bin_type, "") + chunk(bin_type, "")), "a.glb", ErrorCode::invalid_input,
               "duplicate BIN");
  expect_error(glb(json + chunk("UNKN", "") + chunk(bin_type, "")), "a.glb", ErrorCode::invalid_input,
               "not the second chunk");
}

TEST(Document, NamesWhatIsWrongWithJson) {
  expect_error("\xEF\xBB\xBF" + asset_json, "a.gltf", ErrorCode::invalid_input, "byte order mark");
  expect_error("[]", "a.gltf", ErrorCode::invalid_input, "not an object");
  expect_error("{\"asset\":", "a.gltf", ErrorCode::invalid_input, "broken at byte");
  expect_error("{}", "a.gltf", ErrorCode::invalid_input, "no asset");
  expect_error(R"({"asset":{}})", "a.gltf", ErrorCode::invalid_input, "asset has no version");
  expect_error(R"({"asset":{"version":"1.0"}})", "a.gltf", ErrorCode::unsupported, "glTF 1");
  expect_error(R"({"asset":{"version":"3.0"}})", "a.gltf", ErrorCode::unsupported, "glTF 3");
  expect_error(R"({"asset":{"version":"2.0.1-dev"}})", "a.gltf", ErrorCode::invalid_input, "2.0.1-dev");
  expect_error(R"({"asset":{"version":"2.0","minVersion":"2.1"}})", "a.gltf", ErrorCode::invalid_input, "minVersion");
  expect_error(R"({"asset":{"version":"2.0"},"extras":1e999})", "a.gltf", ErrorCode::invalid_input, "out of range");
  expect_error("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(600, '[') + std::string(600, ']') + "}",
               "a.gltf", ErrorCode::unsupported, "nested deeper");
  expect_error(std::string(1000000, '['), "a.gltf", ErrorCode::unsupported, "nested deeper");
}

TEST(Document, NamesWhatIsWrongWithABuffer) {
  const auto with = [](const std::string& buffer) {
    return R"({"asset":{"version":"2.0"},"buffers":[)" + buffer + "]}";
  };
  expect_error(with("{}"), "a.gltf", ErrorCode::invalid_input, "buffers[0] has no byteLength");
  expect_error(with("[]"), "a.gltf", ErrorCode::invalid_input, "buffers[0] is not an object");
  expect_error(with(R"({"byteLength":-1})"), "a.gltf", ErrorCode::invalid_input, "non-negative integer");
  expect_error(with(R"({"byteLength":0})"), "a.gltf", ErrorCode::invalid_input, "byteLength of 0");
  expect_error(with(R"({"byteLength":2,"uri":"data:;base64,AA=="})"), "a.gltf", ErrorCode::invalid_input,
               "buffers[0] needs 2 bytes");
  expect_error(with(R"({"byteLength":1,"uri":"data:;base64,A*=="})"), "a.gltf", ErrorCode::invalid_input,
               "malformed data URI");
  expect_error(with(R"({"byteLength":1,"uri":"data:"})"), "a.gltf", ErrorCode::invalid_input, "malformed data URI");
  expect_error(with(R"({"byteLength":1,"uri":"https://example.org/a.bin"})"), "a.gltf", ErrorCode::unsupported,
               "https://example.org");
  expect_error(with(R"({"byteLength":1,"uri":"%zz"})"), "a.gltf", ErrorCode::invalid_input, "malformed URI");
  expect_error(with(R"({"byteLength":1,"uri":"../a.bin"})"), "a.gltf", ErrorCode::unsupported,
               "out of the input's folder");
  expect_error(with(R"({"byteLength":1,"uri":"/etc/hostname"})"), "a.gltf", ErrorCode::unsupported,
               "out of the input's folder");
  expect_error(glb(chunk("JSON", buffer_json)), "a.glb", ErrorCode::invalid_input, "no BIN chunk");
  expect_error(glb(chunk("JSON", buffer_json) + chunk(bin_type, "abcd")), "a.glb", ErrorCode::invalid_input,
               "needs 6 bytes");
}

TEST(Document, SaysThatAFileIsMissing) {
  const TemporaryFolder folder;
  const nmc::Error missing = error_of([&] { nmc::gltf::read_document(folder / "missing.glb"); });
  EXPECT_EQ(missing.code(), ErrorCode::io);
  EXPECT_THAT(missing.what(), HasSubstr("missing.glb does not exist"));
  const nmc::Error is_folder = error_of([&] { nmc::gltf::read_document(folder.path()); });
  EXPECT_EQ(is_folder.code(), ErrorCode::io);
  EXPECT_THAT(is_folder.what(), HasSubstr("is a folder"));
  write_bytes(folder / "a.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"no.bin"}]})");
  const nmc::Error no_buffer = error_of([&] { nmc::gltf::read_document(folder / "a.gltf"); });
  EXPECT_EQ(no_buffer.code(), ErrorCode::io);
  EXPECT_THAT(no_buffer.what(), HasSubstr("no.bin does not exist"));
}

TEST(Document, ReadsDataUrisAndFiles) {
  const TemporaryFolder folder;
  write_bytes(folder / "my data/a.bin", "12345");
  write_bytes(folder / "a.gltf", R"({"asset":{"version":"2.0"},"buffers":[
    {"byteLength":4,"uri":"my%20data/a.bin"}, {"byteLength":4,"uri":"data:application/octet-stream;base64,AAH/gA=="},
    {"byteLength":3,"uri":"data:,a%20b"}, {"byteLength":100}]})");
  const Document document = nmc::gltf::read_document(folder / "a.gltf");
  EXPECT_EQ(document.buffers[0], (Bytes{'1', '2', '3', '4'}));
  EXPECT_EQ(document.buffers[1], (Bytes{0, 1, 255, 128}));
  EXPECT_EQ(document.buffers[2], (Bytes{'a', ' ', 'b'}));
  EXPECT_THAT(document.has_data, testing::ElementsAre(true, true, true, false));
}

TEST(Document, FollowsNoLinkOutOfTheFolderUnlessAllowed) {
  const TemporaryFolder folder;
  write_bytes(folder / "secret.bin", "s");
  fs::create_directories(folder / "in");
  fs::create_symlink(folder / "secret.bin", folder / "in/link.bin");
  write_bytes(folder / "in/link.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"link.bin"}]})");
  write_bytes(folder / "in/dots.gltf",
              R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"%2e%2e/secret.bin"}]})");
  for (const char* name : {"in/link.gltf", "in/dots.gltf"}) {
    EXPECT_EQ(error_of([&] { nmc::gltf::read_document(folder / name); }).code(), ErrorCode::unsupported);
    EXPECT_EQ(nmc::gltf::read_document(folder / name, {.allow_external = true}).buffers[0], Bytes{'s'});
  }
}

TEST(Document, RoundTripKeepsJsonBytesAndChunks) {
  const std::string json = padded(
      R"({"zebra":[1.0,1,-0.1,0.30000001192092896,1e-07,18446744073709551615],"asset":{"version":"2.0","extras":{"b":null,"a":{}}},"buffers":[{"byteLength":6}]})");
  const std::string file = glb(chunk("JSON", json) + chunk(bin_type, std::string("abcdef\0\0", 8)) +
                               chunk("XTRA", "wxyz") + chunk("NEXT", ""));
  const Document document = parse(file, "a.glb");
  const Bytes again = nmc::gltf::to_glb(document);
  EXPECT_EQ(std::string(again.begin(), again.end()), file);
}

TEST(Document, KeepsABinChunkThatNoBufferUses) {
  const std::string file = glb(chunk("JSON", asset_json) + chunk(bin_type, "abcd"));
  const Bytes again = nmc::gltf::to_glb(parse(file, "a.glb"));
  EXPECT_EQ(std::string(again.begin(), again.end()), file);
}

TEST(Document, TurnsGltfIntoGlbAndBack) {
  const TemporaryFolder folder;
  write_bytes(folder / "in/a.bin", "1234567");
  write_bytes(folder / "in/textures/skin.png", "pixels");
  write_bytes(folder / "in/a.gltf",
              R"({"asset":{"version":"2.0"},"images":[{"uri":"textures/skin.png"},{"uri":"https://example.org/x.png"}],
    "buffers":[{"uri":"a.bin","byteLength":7},{"byteLength":4,"uri":"data:application/octet-stream;base64,AAH/gA=="},
               {"uri":"a.bin","byteLength":2}]})");
  fs::create_directories(folder / "out");
  const Document source = nmc::gltf::read_document(folder / "in/a.gltf");

  nmc::gltf::write_document(source, folder / "out/b.glb");
  const Document packed = nmc::gltf::read_document(folder / "out/b.glb");
  EXPECT_EQ(packed.buffers, source.buffers);
  EXPECT_FALSE(packed.json["buffers"][0].contains("uri"));
  EXPECT_EQ(packed.json["buffers"][1], source.json["buffers"][1]);
  EXPECT_THAT(packed.json["buffers"][2]["uri"].get<std::string>(), testing::StartsWith("data:"));
  EXPECT_EQ(packed.json["images"], source.json["images"]);
  EXPECT_EQ(read_bytes(folder / "out/textures/skin.png"), "pixels");

  nmc::gltf::write_document(packed, folder / "out/two words.gltf");
  const Document unpacked = nmc::gltf::read_document(folder / "out/two words.gltf");
  EXPECT_EQ(unpacked.buffers, source.buffers);
  EXPECT_EQ(unpacked.json["buffers"][0]["uri"], "two%20words.bin");
  EXPECT_EQ(read_bytes(folder / "out/two words.bin"), "1234567");
}

TEST(Document, NeverOverwritesADifferentImageNorTheInputsFiles) {
  const TemporaryFolder folder;
  write_bytes(folder / "in/a.bin", "1234567");
  write_bytes(folder / "in/skin.png", "pixels");
  write_bytes(folder / "out/skin.png", "other pixels");
  write_bytes(
      folder / "in/b.gltf",
      R"({"asset":{"version":"2.0"},"images":[{"uri":"skin.png"}],"buffers":[{"uri":"a.bin","byteLength":7}]})");
  const Document document = nmc::gltf::read_document(folder / "in/b.gltf");
  const nmc::Error image = error_of([&] { nmc::gltf::write_document(document, folder / "out/b.glb"); });
  EXPECT_EQ(image.code(), ErrorCode::io);
  EXPECT_THAT(image.what(), HasSubstr("skin.png exists already"));
  EXPECT_FALSE(fs::exists(folder / "out/b.glb"));
  EXPECT_EQ(read_bytes(folder / "out/skin.png"), "other pixels");
  const nmc::Error buffer = error_of([&] { nmc::gltf::write_document(document, folder / "in/a.gltf"); });
  EXPECT_EQ(buffer.code(), ErrorCode::io);
  EXPECT_THAT(buffer.what(), HasSubstr("belongs to the input"));
}

TEST(Document, OutputMayBeTheInput) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.bin", "1234567");
  write_bytes(folder / "a.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":7}]})");
  Document document = nmc::gltf::read_document(folder / "a.gltf");
  document.buffers[0] = {'n', 'e', 'w'};
  document.json["buffers"][0]["byteLength"] = 3;
  nmc::gltf::write_document(document, folder / "a.gltf");
  EXPECT_EQ(nmc::gltf::read_document(folder / "a.gltf").buffers[0], (Bytes{'n', 'e', 'w'}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(Document, AFailedWriteLeavesNothingBehind) {
  const TemporaryFolder folder;
  const Document document = parse(glb(chunk("JSON", buffer_json) + chunk(bin_type, "abcdefgh")), "a.glb");
  fs::create_directories(folder / "b.glb");
  EXPECT_EQ(error_of([&] { nmc::gltf::write_document(document, folder / "b.glb"); }).code(), ErrorCode::io);
  EXPECT_EQ(error_of([&] { nmc::gltf::write_document(document, folder / "missing/b.glb"); }).code(), ErrorCode::io);
  EXPECT_EQ(error_of([&] { nmc::gltf::write_document(document, "/dev/full.glb/x.glb"); }).code(), ErrorCode::io);
  EXPECT_EQ(error_of([&] { nmc::gltf::write_document(document, folder / "b.obj"); }).code(), ErrorCode::usage);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(Document, StoredViewIsChecked) {
  const std::string json = padded(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":6}],"bufferViews":[
    {"buffer":0,"byteOffset":2,"byteLength":4},{"buffer":0,"byteOffset":4,"byteLength":3},{"buffer":1,"byteLength":1},
    {"buffer":0,"byteOffset":9007199254740991,"byteLength":9007199254740991}]})");
  const Document document = parse(glb(chunk("JSON", json) + chunk(bin_type, "abcdefgh")), "a.glb");
  const auto view = nmc::gltf::stored_view(document, 0);
  EXPECT_EQ(std::string(view.begin(), view.end()), "cdef");
  for (std::size_t i = 1; i < 5; ++i) {
    const nmc::Error error = error_of([&] { nmc::gltf::stored_view(document, i); });
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    EXPECT_THAT(error.what(), HasSubstr("bufferViews[" + std::to_string(i) + "]"));
  }
}

TEST(Document, RealFilesComeBackAsTheyWere) {
  const fs::path data = fs::path(NMC_SHARED_DIR) / "data";
  if (!fs::exists(data)) GTEST_SKIP() << "no shared data";
  for (const char* name :
       {"game/knight_76clips.glb", "game/fox.glb", "odd/Fox_cc_af0.glb", "odd/InterpolationTest.glb"}) {
    const Document document = nmc::gltf::read_document(data / name);
    const Bytes bytes = nmc::gltf::to_glb(document);
    const Document again = nmc::gltf::parse_document(bytes, "again.glb", "/nowhere");
    EXPECT_EQ(again.json, document.json) << name;
    EXPECT_EQ(again.json.dump(), document.json.dump()) << name;
    EXPECT_EQ(again.buffers, document.buffers) << name;
  }
}

}  // namespace
