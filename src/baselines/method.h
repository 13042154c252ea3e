// The systems that gltf-nmc is compared with, each a codec behind one interface.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "baselines/bytes.h"
#include "codec/source.h"
#include "motion/clip.h"
#include "motion/skeleton.h"

namespace nmc::baselines {

struct EncodeSettings {
  int effort = 5;   ///< of gltf-nmc's own default
  int threads = 1;  ///< at most
};

/// Made for one source, which outlives it; keeps what several encodings of it have in common. Same source and knob,
/// same bytes, in any order of calls.
class Encoder {
 public:
  virtual ~Encoder() = default;

  /// All clips of the source. `knob`: the one setting of quality, above 0, as a share of the character's size; smaller
  /// is finer. What a method makes of it is said where it is defined.
  virtual Bytes encode(double knob) = 0;
};

/// What a decoder knows beside the bytes is the skeleton as any glTF file keeps it (node tree, names, rest pose, which
/// nodes are joints): the same for all methods. Everything else is counted: key times, which node moves how, values of
/// what stands still.
struct Method {
  std::string_view name;
  std::string_view source;   ///< where it comes from
  std::string_view knob;     ///< what the knob decides
  bool keeps_bound = false;  ///< encode(t) looks for the fewest bytes with the error within t by itself
  std::unique_ptr<Encoder> (*prepare)(const codec::Source&, const EncodeSettings&) = nullptr;

  /// The clips in the order of the source. Throws Error (invalid_input) for bytes that no encoder wrote.
  std::vector<motion::Clip> (*decode)(std::span<const std::uint8_t>, const motion::Skeleton&) = nullptr;
};

/// All of them, gltf-nmc's own first.
std::span<const Method> all_methods();

/// Null where there is none of that name.
const Method* find_method(std::string_view name);

/// The largest error of decoded clips, at joints and skin points, in world units.
double largest_error(const codec::Source& source, const motion::ErrorMeter& meter, std::size_t clip,
                     const motion::Clip& decoded);

}  // namespace nmc::baselines
