// make_characters OUTDIR [--list]: writes the sample characters as GLB files.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "samples/characters.h"

namespace {

void write_file(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

void write_all(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const nmc::samples::CharacterInfo& info : nmc::samples::list_characters()) {
    const std::vector<std::uint8_t> bytes = nmc::samples::make_character(info.file_name);
    write_file(folder / info.file_name, bytes);
    std::printf("%-24s %9zu bytes  %s\n", info.file_name.c_str(), bytes.size(), info.description.c_str());
  }
}

void list_all() {
  for (const nmc::samples::CharacterInfo& info : nmc::samples::list_characters()) {
    std::printf("%-24s %s\n", info.file_name.c_str(), info.description.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  bool list = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--list") {
      list = true;
    } else if (folder.empty() && !argument.starts_with("-")) {
      folder = argument;
    } else {
      folder.clear();
      list = false;
      break;
    }
  }
  if (!list && folder.empty()) {
    std::fputs(
        "usage: make_characters OUTDIR    write all sample characters there\n"
        "       make_characters --list    say what they are\n",
        stderr);
    return 1;
  }
  try {
    if (list) {
      list_all();
    } else {
      write_all(folder);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "Error: %s\n", error.what());
    return 4;
  }
  return 0;
}
