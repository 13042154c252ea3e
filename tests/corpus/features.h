// Small made files, one for each thing that animations of glTF can be.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/scratch.h"

namespace nmc::test {

struct Feature {
  std::string name;             ///< as the table of docs/compatibility.md calls it
  std::string example;          ///< what the file holds
  std::function<Bytes()> make;  ///< a GLB
};

/// All features, in the order of the table.
const std::vector<Feature>& features();

}  // namespace nmc::test
