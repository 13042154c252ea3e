// A document without animations expands to itself.
#include <codec/compress.h>

#include <string>

int main() {
  const std::string json = R"({"asset": {"version": "2.0"}})";
  const nmc::gltf::Document document =
      nmc::gltf::parse_document({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()}, "empty.gltf", ".");
  return nmc::codec::expand(document).json == document.json ? 0 : 1;
}
