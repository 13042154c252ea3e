// What `gltf-nmc verify` tells: the error of each animation against the tolerance.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/compress.h"

namespace nmc::report {

struct VerifyContext {
  std::string version;
  std::string original;
  std::string other;
  bool has_exceptions = false;  ///< some channels have a tolerance of their own
  bool joints_alone = false;    ///< the tolerance holds for skin joints only, not for the skin (the paper's measure)
  std::vector<std::string> node_names;
};

/// Whether the tolerance holds for one animation, for all. An error that is not a number does not hold.
bool holds(const codec::VerifiedClip& clip, const VerifyContext& context);
bool holds(const codec::Verification& result, const VerifyContext& context);

std::string verify_text(const codec::Verification& result, const VerifyContext& context);
nlohmann::ordered_json verify_json(const codec::Verification& result, const VerifyContext& context);

}  // namespace nmc::report
