// Work in a process of its own, so that each has its own peak of memory.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nmc::bench {

/// The most memory that this process has had resident, in bytes.
std::size_t peak_resident_bytes();

/// Runs `work` in a forked child and returns what it returned. To be called while the process has one thread. Throws
/// Error with the child's sentence when it failed.
nlohmann::json run_apart(const std::function<nlohmann::json()>& work);

struct ProgramRun {
  int exit_code = -1;  ///< -1: it did not start or a signal ended it
  double seconds = 0;
  std::size_t peak_bytes = 0;
};

/// Runs a program (looked up in PATH) to its end, without input and output.
ProgramRun run_program(const std::vector<std::string>& arguments);

}  // namespace nmc::bench
