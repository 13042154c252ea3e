// nmc_expand IN.glb OUT.glb: turns a compressed GLB into a plain one in memory, as an engine without hooks does before
// it hands the bytes to its loader.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "codec/compress.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot be read");
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

/// What an engine copies: bytes in, bytes out.
Bytes expand(const Bytes& compressed, const std::string& name) {
  return nmc::gltf::to_glb(nmc::codec::expand(nmc::gltf::parse_document(compressed, name, ".")));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::fprintf(stderr, "usage: nmc_expand IN.glb OUT.glb\n");
    return 1;
  }
  try {
    const Bytes plain = expand(read(arguments[1]), arguments[1]);
    std::ofstream file(arguments[2], std::ios::binary);
    file.write(reinterpret_cast<const char*>(plain.data()), static_cast<std::streamsize>(plain.size()));
    if (!file.flush()) throw std::runtime_error("cannot be written");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nmc_expand: %s\n", error.what());
    return 2;
  }
}
