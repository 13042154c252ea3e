#include "motion/bvh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <glm/gtc/constants.hpp>
#include <optional>

#include "base/decimal.h"
#include "base/error.h"

namespace nmc::motion {
namespace {

constexpr std::size_t max_depth = 1000;
constexpr std::size_t max_joint_channels = 64;

enum class ChannelKind : std::uint8_t { position, rotation };

struct BvhChannel {
  ChannelKind kind = ChannelKind::rotation;
  int axis = 0;  ///< 0 x, 1 y, 2 z
};

struct Joint {
  std::string name;
  int parent = -1;
  bool is_end_site = false;
  bool has_offset = false;
  glm::dvec3 offset{0.0};
  std::size_t first_channel = 0;
  std::vector<BvhChannel> channels;

  bool has(ChannelKind kind) const {
    return std::any_of(channels.begin(), channels.end(), [=](const BvhChannel& c) { return c.kind == kind; });
  }
};

struct Hierarchy {
  std::vector<Joint> joints;
  std::size_t channel_count = 0;
};

struct Motion {
  double frame_seconds = 0;
  std::size_t frames = 0;
  std::vector<double> values;  ///< frames x channel_count
};

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

bool same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

/// The length of the well-formed UTF-8 sequence (Unicode, table 3-7) that starts `text`, or 0.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xc2 && lead < 0xe0   ? 2
                             : lead >= 0xe0 && lead < 0xf0 ? 3
                             : lead >= 0xf0 && lead < 0xf5 ? 4
                                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) < 0x80 || byte(i) > 0xbf) return 0;
  }
  const bool overlong = (lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xf0 && byte(1) < 0x90);
  const bool no_character = (lead == 0xed && byte(1) > 0x9f) || (lead == 0xf4 && byte(1) > 0x8f);
  return overlong || no_character ? 0 : length;
}

/// Names go into JSON, which is UTF-8: control characters and what is not well-formed become '?'.
std::string clean_name(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const bool control = length == 1 && (text[0] < 0x20 || text[0] == 0x7f);
    if (length == 0 || control) {
      out += '?';
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

/// Words of the text with their lines. Braces are words of their own.
class Words {
 public:
  Words(std::string_view text, const std::string& file_name) : text_(text), file_name_(file_name) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);
    skip_blanks();
  }

  bool at_end() const { return at_ == text_.size(); }
  std::size_t bytes_left() const { return text_.size() - at_; }

  /// The next word without taking it; empty at the end.
  std::string_view peek() const {
    if (at_end()) return {};
    if (is_brace(text_[at_])) return text_.substr(at_, 1);
    std::size_t end = at_;
    while (end < text_.size() && !is_blank(text_[end]) && !is_brace(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }

  std::string_view next(const char* wanted) {
    const std::string_view word = peek();
    if (word.empty()) fail(fmt::format("the file ends where {} should be", wanted));
    at_ += word.size();
    skip_blanks();
    return word;
  }

  /// Takes the next word where it is `word`.
  bool take(std::string_view word) {
    if (!same_word(peek(), word)) return false;
    next("");
    return true;
  }

  void expect(const char* word) {
    if (!take(word)) fail(fmt::format("there should be {} instead of '{}'", word, shown(peek())));
  }

  double number(const char* wanted) {
    const std::size_t line = line_;
    const std::string_view word = next(wanted);
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    const auto [end, failure] = read_decimal(digits.data(), digits.data() + digits.size(), value);
    if (failure != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      fail_at(line, fmt::format("there should be {} instead of '{}'", wanted, shown(word)));
    }
    return value;
  }

  std::size_t count(const char* wanted) {
    const std::size_t line = line_;
    const std::string_view word = next(wanted);
    std::size_t value = 0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failure != std::errc() || end != word.data() + word.size()) {
      fail_at(line, fmt::format("there should be {} instead of '{}'", wanted, shown(word)));
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& clause) const { fail_at(line_, clause); }

 private:
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  static std::string shown(std::string_view word) {
    return word.empty() ? "the end of the file" : clean_name(word.substr(0, 40));
  }

  [[noreturn]] void fail_at(std::size_t line, const std::string& clause) const {
    throw Error(ErrorCode::invalid_input, fmt::format("{}, line {}: {}.", file_name_, line, clause));
  }

  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
  }

  std::string_view text_;
  const std::string& file_name_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

std::optional<BvhChannel> channel_of(std::string_view word) {
  constexpr std::array<std::string_view, 3> positions{"Xposition", "Yposition", "Zposition"};
  constexpr std::array<std::string_view, 3> rotations{"Xrotation", "Yrotation", "Zrotation"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (same_word(word, positions[axis])) return BvhChannel{ChannelKind::position, static_cast<int>(axis)};
    if (same_word(word, rotations[axis])) return BvhChannel{ChannelKind::rotation, static_cast<int>(axis)};
  }
  return std::nullopt;
}

void read_channels(Words& words, Joint& joint, Hierarchy& hierarchy) {
  if (joint.is_end_site) words.fail("an end site cannot have CHANNELS");
  if (!joint.channels.empty()) words.fail(fmt::format("joint '{}' has CHANNELS twice", joint.name));
  const std::size_t count = words.count("the number of channels");
  if (count > max_joint_channels)
    words.fail(fmt::format("joint '{}' has more than {} channels", joint.name, max_joint_channels));
  joint.first_channel = hierarchy.channel_count;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<BvhChannel> channel = channel_of(words.peek());
    if (!channel)
      words.fail(fmt::format("channel {} of joint '{}' is neither a position nor a rotation", i + 1, joint.name));
    words.next("");
    joint.channels.push_back(*channel);
  }
  hierarchy.channel_count += count;
}

/// The words up to the opening brace, which is taken too.
std::string read_name(Words& words) {
  std::string name;
  while (!words.at_end() && words.peek() != "{") {
    if (words.peek() == "}") words.fail("there should be { instead of }");
    if (!name.empty()) name += ' ';
    name += words.next("");
  }
  words.expect("{");
  return clean_name(name);
}

void open_joint(Words& words, Hierarchy& hierarchy, std::vector<int>& open) {
  Joint joint;
  joint.is_end_site = words.take("End");
  if (!joint.is_end_site && !words.take("JOINT")) words.expect("ROOT");
  joint.parent = open.empty() ? -1 : open.back();
  joint.first_channel = hierarchy.channel_count;
  const std::string name = read_name(words);
  if (joint.is_end_site) {
    joint.name = hierarchy.joints[static_cast<std::size_t>(joint.parent)].name + "_end";
  } else {
    joint.name = name.empty() ? fmt::format("joint {}", hierarchy.joints.size()) : name;
  }
  open.push_back(static_cast<int>(hierarchy.joints.size()));
  if (open.size() > max_depth) words.fail(fmt::format("joints are nested deeper than {}", max_depth));
  hierarchy.joints.push_back(std::move(joint));
}

void close_joint(Words& words, const Hierarchy& hierarchy, std::vector<int>& open) {
  const Joint& joint = hierarchy.joints[static_cast<std::size_t>(open.back())];
  if (!joint.has_offset) words.fail(fmt::format("joint '{}' has no OFFSET", joint.name));
  words.expect("}");
  open.pop_back();
}

/// What stands inside the braces of the innermost open joint.
void read_joint_entry(Words& words, Hierarchy& hierarchy, std::vector<int>& open) {
  Joint& joint = hierarchy.joints[static_cast<std::size_t>(open.back())];
  const std::string_view word = words.peek();
  if (word == "}") return close_joint(words, hierarchy, open);
  if (words.take("OFFSET")) {
    for (int axis = 0; axis < 3; ++axis) joint.offset[axis] = words.number("a number of the OFFSET");
    joint.has_offset = true;
    return;
  }
  if (words.take("CHANNELS")) return read_channels(words, joint, hierarchy);
  if (!joint.is_end_site && (same_word(word, "JOINT") || same_word(word, "End")))
    return open_joint(words, hierarchy, open);
  words.fail(fmt::format("inside joint '{}' there should be OFFSET, CHANNELS, JOINT, End Site or }}", joint.name));
}

Hierarchy read_hierarchy(Words& words) {
  words.expect("HIERARCHY");
  Hierarchy hierarchy;
  while (same_word(words.peek(), "ROOT")) {
    std::vector<int> open;
    open_joint(words, hierarchy, open);
    while (!open.empty()) read_joint_entry(words, hierarchy, open);
  }
  if (hierarchy.joints.empty()) words.fail("there should be a ROOT");
  if (hierarchy.channel_count == 0) words.fail("no joint has CHANNELS");
  return hierarchy;
}

Motion read_motion(Words& words, std::size_t channel_count) {
  words.expect("MOTION");
  Motion motion;
  if (!words.take("Frames:")) {
    words.expect("Frames");
    words.expect(":");
  }
  motion.frames = words.count("the number of frames");
  words.expect("Frame");
  if (!words.take("Time:")) {
    words.expect("Time");
    words.expect(":");
  }
  motion.frame_seconds = words.number("the frame time in seconds");
  if (!(motion.frame_seconds > 0)) words.fail("the frame time must be greater than 0");
  if (motion.frames == 0) words.fail("the file has no frames");
  // a number takes a digit and a blank, so this also bounds the allocation by the size of the file
  const std::size_t most = (words.bytes_left() + 1) / 2;
  if (motion.frames > most / channel_count) {
    words.fail(fmt::format("{} frames of {} channels are announced, but the file is too short to hold them",
                           motion.frames, channel_count));
  }
  motion.values.reserve(motion.frames * channel_count);
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    for (std::size_t i = 0; i < channel_count; ++i) {
      if (words.at_end()) words.fail(fmt::format("the file ends in frame {} of {}", frame + 1, motion.frames));
      motion.values.push_back(words.number("a number"));
    }
  }
  if (!words.at_end()) words.fail(fmt::format("there is more text after the last of {} frames", motion.frames));
  return motion;
}

/// Which frames stay, as a step, for a wanted rate.
std::size_t frame_step(double frame_seconds, double frames_per_second, std::size_t frames) {
  if (!(frames_per_second > 0)) return 1;
  const double step = std::round(1 / (frame_seconds * frames_per_second));
  return step >= static_cast<double>(frames) ? frames : std::max<std::size_t>(1, static_cast<std::size_t>(step));
}

class Converter {
 public:
  Converter(const Hierarchy& hierarchy, const Motion& motion, std::size_t step, double scale)
      : hierarchy_(hierarchy), motion_(motion), step_(step), scale_(scale) {}

  std::size_t frames() const { return (motion_.frames + step_ - 1) / step_; }

  /// Sign-continuous unit quaternions x, y, z, w.
  std::vector<float> rotations(const Joint& joint) const {
    std::vector<float> out;
    out.reserve(4 * frames());
    glm::dquat previous(1, 0, 0, 0);
    for (std::size_t frame = 0; frame < motion_.frames; frame += step_) {
      glm::dquat q = rotation(joint, frame);
      if (glm::dot(q, previous) < 0) q = -q;
      previous = q;
      for (const double v : {q.x, q.y, q.z, q.w}) out.push_back(static_cast<float>(v));
    }
    return out;
  }

  /// Scaled translations; axes without a channel keep the offset.
  std::vector<float> translations(const Joint& joint) const {
    std::vector<float> out;
    out.reserve(3 * frames());
    for (std::size_t frame = 0; frame < motion_.frames; frame += step_) {
      glm::dvec3 p = joint.offset;
      for (std::size_t c = 0; c < joint.channels.size(); ++c) {
        if (joint.channels[c].kind == ChannelKind::position) p[joint.channels[c].axis] = value(joint, frame, c);
      }
      for (int axis = 0; axis < 3; ++axis) out.push_back(static_cast<float>(scale_ * p[axis]));
    }
    return out;
  }

  std::vector<float> times() const {
    std::vector<float> out;
    for (std::size_t i = 0; i < frames(); ++i) {
      out.push_back(static_cast<float>(static_cast<double>(i * step_) * motion_.frame_seconds));
    }
    return out;
  }

 private:
  double value(const Joint& joint, std::size_t frame, std::size_t channel) const {
    return motion_.values[frame * hierarchy_.channel_count + joint.first_channel + channel];
  }

  glm::dquat rotation(const Joint& joint, std::size_t frame) const {
    glm::dquat q(1, 0, 0, 0);
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      if (joint.channels[c].kind != ChannelKind::rotation) continue;
      const double half = std::remainder(value(joint, frame, c), 720.0) * glm::pi<double>() / 360.0;
      glm::dquat turn(std::cos(half), 0, 0, 0);
      (joint.channels[c].axis == 0 ? turn.x : joint.channels[c].axis == 1 ? turn.y : turn.z) = std::sin(half);
      q = q * turn;
    }
    return glm::normalize(q);
  }

  const Hierarchy& hierarchy_;
  const Motion& motion_;
  std::size_t step_;
  double scale_;
};

bool constant_rows(const std::vector<float>& values, std::size_t width) {
  for (std::size_t i = width; i < values.size(); ++i) {
    if (values[i] != values[i % width]) return false;
  }
  return true;
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

void add_node(Skeleton& skeleton, const Joint& joint, double scale) {
  const int node = static_cast<int>(skeleton.size());
  Transform rest;
  rest.translation = scale * joint.offset;
  skeleton.names.push_back(joint.name);
  skeleton.parent.push_back(joint.parent);
  skeleton.order.push_back(node);
  skeleton.rest.push_back(rest);
  skeleton.rest_weights.emplace_back();
  if (!joint.is_end_site) skeleton.joints.push_back(node);
}

}  // namespace

BvhClip parse_bvh(std::string_view text, const std::string& file_name, const BvhOptions& options) {
  Words words(text, file_name);
  const Hierarchy hierarchy = read_hierarchy(words);
  const Motion motion = read_motion(words, hierarchy.channel_count);
  const std::size_t step = frame_step(motion.frame_seconds, options.frames_per_second, motion.frames);
  const Converter converter(hierarchy, motion, step, options.scale);
  const auto refuse = [&](const std::string& clause) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: {}.", file_name, clause));
  };

  BvhClip result;
  Clip& clip = result.clip;
  clip.name = options.clip_name;
  clip.times = converter.times();
  const bool increasing =
      std::adjacent_find(clip.times.begin(), clip.times.end(), std::greater_equal<>()) == clip.times.end();
  if (!increasing || !all_finite(clip.times))
    refuse(fmt::format("a frame time of {} s does not fit glTF's float times", motion.frame_seconds));

  for (const Joint& joint : hierarchy.joints) {
    const int node = static_cast<int>(result.skeleton.size());
    add_node(result.skeleton, joint, options.scale);
    if (joint.is_end_site) continue;
    glm::dvec3& rest = result.skeleton.rest.back().translation;
    if (joint.has(ChannelKind::position)) {
      std::vector<float> values = converter.translations(joint);
      if (!all_finite(values)) refuse(fmt::format("a position of joint '{}' is too large", joint.name));
      if (joint.parent >= 0 && constant_rows(values, 3)) {
        rest = glm::dvec3(values[0], values[1], values[2]);
      } else {
        clip.tracks.push_back({node, Path::translation, 3, std::move(values)});
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(static_cast<float>(rest[axis])))
        refuse(fmt::format("the OFFSET of joint '{}' is too large", joint.name));
    }
    if (joint.has(ChannelKind::rotation)) clip.tracks.push_back({node, Path::rotation, 4, converter.rotations(joint)});
  }
  for (const Transform& rest : result.skeleton.rest)
    result.skeleton.rest_matrix.push_back(glm::translate(glm::dmat4(1.0), rest.translation));
  return result;
}

}  // namespace nmc::motion
