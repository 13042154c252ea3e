// How every part of gltf-nmc reports failure: one exception type, one code per kind, one sentence for the user.
#pragma once

#include <stdexcept>
#include <string>

namespace nmc {

/// The kind of a failure. The values are the exit codes of the command-line tool.
enum class ErrorCode {
  usage = 1,               ///< the command line makes no sense
  io = 2,                  ///< a file cannot be read or written
  invalid_input = 3,       ///< the file breaks its format
  unsupported = 4,         ///< the file is valid but needs something that is not built
  tolerance_not_kept = 5,  ///< the error is larger than the tolerance
  internal = 6,            ///< a defect in gltf-nmc itself
};

/// A failure with a sentence that says which file, which object, what is wrong, and what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace nmc
