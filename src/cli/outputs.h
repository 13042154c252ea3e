// Which output each input of a command gets.
#pragma once

#include <string>
#include <vector>

namespace nmc::cli {

struct FilePair {
  std::string input;
  std::string output;
};

struct Outputs {
  std::vector<FilePair> files;  ///< in the order of the command line
  std::string folder;           ///< with -o FOLDER; "" where IN and OUT were named
};

/// `files` as IN OUT where `output` (-o) is empty; one input and the file `output` where that ends in .glb or .gltf and
/// is no folder; else all into the folder `output` under their own names. Touches no file. Throws Error (usage): files
/// missing or too many, several inputs for one file, two inputs of the same name, a name that does not end in .glb or
/// .gltf.
Outputs plan_outputs(const std::vector<std::string>& files, const std::string& output);

/// Makes the folder, and those above it, where they are missing. Throws Error (io).
void make_folder(const std::string& folder);

}  // namespace nmc::cli
