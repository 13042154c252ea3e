// What the papers measure, on a file's animations and what a method made of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "baselines/method.h"
#include "codec/source.h"

namespace nmc::bench {

/// The papers' measures of decoded clips.
struct PaperMeasures {
  double mean_joint_cm = 0;       ///< Lin et al.: mean distance of joints over all frames
  double max_joint_share = 0;     ///< Tojo et al.: largest distance, share of size
  double distortion_percent = 0;  ///< Liu and McMillan: d
};

std::unique_ptr<codec::Source> read_motion(const std::filesystem::path& path);
PaperMeasures measure_as_papers(const codec::Source& source, const std::vector<motion::Clip>& decoded);

std::size_t frame_count(const codec::Source& source);

/// Bytes of three float32 angles per joint and the root's position: what Lin et al. count (383 bytes a frame of 31
/// joints).
std::size_t raw_joint_bytes(const codec::Source& source);

/// CPU seconds of this thread.
double thread_seconds();

/// The tables, in Markdown on standard output.
void print_tojo(const std::vector<std::filesystem::path>& files, int max_frequencies);
void print_liu(const std::vector<std::filesystem::path>& files);
void print_lin(const std::vector<std::filesystem::path>& files_120_hz,
               const std::vector<std::filesystem::path>& files_30_hz);

}  // namespace nmc::bench
