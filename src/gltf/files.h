// Files on disk: read whole, and replaced only when the new content is complete and synced.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "gltf/document.h"

namespace nmc::gltf {

/// The bytes of a regular file, at most `limit` of them. Throws Error (io): missing, a folder, unreadable;
/// std::bad_alloc.
Bytes read_file(const std::filesystem::path& path, std::uint64_t limit = UINT64_MAX);

/// Files that replace others together: each is written under a temporary name beside its target and synced; `commit`
/// renames them in the order in which they were added. Without commit nothing is left behind.
class FileReplacement {
 public:
  FileReplacement() = default;
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;
  ~FileReplacement();

  /// Writes and syncs the bytes under a temporary name. Throws Error (io).
  void add(const std::filesystem::path& target, std::span<const std::uint8_t> bytes);

  /// Renames all files over their targets. Throws Error (io).
  void commit();

 private:
  struct Pending {
    std::filesystem::path temporary;
    std::filesystem::path target;
  };
  std::vector<Pending> pending_;
};

/// Removes the temporary files of all replacements and lets none begin or commit any more; a commit that has begun is
/// waited for. For a process that is about to end: whoever writes afterwards waits for ever.
void abandon_replacements();

/// Keeps other runs that write into the same folder out as long as it lives, where the file system can do that. Files
/// that belong together are chosen and replaced under it.
class FolderLock {
 public:
  /// Waits for the folder. One that cannot be locked is not.
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_;
};

}  // namespace nmc::gltf
