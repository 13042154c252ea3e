// One row of the rate table: what a method made of a file at a tolerance.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace nmc::bench {

struct Measurement {
  std::string method;
  bool reached = false;        ///< bytes and errors count
  std::size_t key_bytes = 0;   ///< gltf::total_cost of the file that was made
  std::size_t json_bytes = 0;  ///< likewise
  double error = 0;            ///< over joints and all skin points, share of the character's size
  double joint_error = 0;      ///< over joints alone, share of the character's size
  double jitter = 0;           ///< motion::ErrorReport, share of the character's size, the largest of any animation
  double loop_seam = no_loop;  ///< likewise, of the animations that are loops
  double contact_drift = 0;    ///< likewise
  bool joints_only = false;    ///< the method's bound is on joints alone
  double seconds = 0;          ///< of compressing
  std::size_t peak_bytes = 0;  ///< resident memory at the end of compressing, at most
  std::string note;

  static constexpr double no_loop = -1;  ///< the loop seam where no animation is a loop
};

/// The method's name of the default profile at an effort.
inline std::string default_method(int effort) { return "default, effort " + std::to_string(effort); }

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Measurement, method, reached, key_bytes, json_bytes, error, joint_error, jitter,
                                   loop_seam, contact_drift, joints_only, seconds, peak_bytes, note)

}  // namespace nmc::bench
