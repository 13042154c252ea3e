// A stream opened by the reference decoder, with the memory it needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "codec/clip_set.h"
#include "motion/clip.h"

struct nmc_set;

namespace nmc::codec {

/// Several threads may read one at once.
class DecodedSet {
 public:
  /// Opens and checks a stream. `name` names it in messages. Throws Error (invalid_input).
  DecodedSet(std::span<const std::uint8_t> stream, const std::string& name);
  ~DecodedSet();
  DecodedSet(DecodedSet&&) noexcept;
  DecodedSet& operator=(DecodedSet&&) noexcept;

  std::size_t clip_count() const;
  std::size_t target_count() const;
  Path path(std::size_t target) const;
  int width(std::size_t target) const;
  const nmc_set& raw() const;
  PartBits bits() const;                      ///< of the payload, by part
  double clip_bits(std::size_t index) const;  ///< of the payload, what belongs to one clip

  /// Clip `index` with the tracks of all targets that it moves or holds; nodes[t] is target t's node. The tracks' name
  /// stays empty.
  motion::Clip clip(std::size_t index, std::span<const int> nodes) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nmc::codec
