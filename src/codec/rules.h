// What a user asks for beside one tolerance for all: patterns that name clips, joints and channels. Plain data.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/animation.h"

namespace nmc::codec {

/// The error that a user accepts.
struct Tolerance {
  enum class Unit { fraction_of_size, world_units };
  double value = 0.001;
  Unit unit = Unit::fraction_of_size;
};

/// Some channels. In the patterns * stands for any characters and ? for one; an empty pattern matches every name.
struct Selector {
  std::string clip;          ///< pattern for the animation's name
  std::string joint;         ///< pattern for the node's name
  std::optional<Path> path;  ///< none: every property
};

/// The tolerance of the points that the selected channels move at first hand: a translation the joint's origin, a
/// rotation or scale the skin of the joint and the origins of its children, weights the morphed mesh. Without a path:
/// the joint's origin, skin and morphs.
struct ToleranceRule {
  Selector where;
  Tolerance tolerance;
};

/// Whether the whole of `name` fits `pattern`.
bool matches(std::string_view pattern, std::string_view name);

bool selects_clip(const Selector& selector, std::string_view clip);

/// Whether the selector names one channel of a clip that it selects.
bool selects_channel(const Selector& selector, std::string_view joint, Path path);

}  // namespace nmc::codec
