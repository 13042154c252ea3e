// Reads whole files, and writes files so that a reader sees the old content or the new, never a part.
#include "gltf/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>
#include <set>
#include <system_error>

#include "base/error.h"

namespace nmc::gltf {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& sentence) { throw Error(ErrorCode::io, sentence); }

std::string reason(int code) { return std::generic_category().message(code); }

/// An open file descriptor that is closed whatever happens.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }
  /// Closes and tells whether that worked.
  bool close() { return ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_;
};

void write_all(int descriptor, std::span<const std::uint8_t> bytes, const fs::path& target) {
  constexpr std::size_t largest_write_bytes = std::size_t{1} << 30;
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), largest_write_bytes));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(fmt::format("{} cannot be written: {}.", target.string(), reason(errno)));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// The file behind symbolic links, so that a link stays a link; `target` itself when it does not exist yet.
fs::path behind_links(const fs::path& target) {
  std::error_code error;
  if (!fs::is_symlink(target, error)) return target;
  const fs::path real = fs::weakly_canonical(target, error);
  return error ? target : real;
}

/// The temporary files of this process. The lock is held whenever one of them appears, goes or becomes its target.
struct Unfinished {
  std::mutex lock;
  std::set<fs::path> files;
};

Unfinished& unfinished() {
  static Unfinished* const all = new Unfinished;  // never destroyed: an interrupt may come while the process ends
  return *all;
}

int create_temporary(const fs::path& path) {
  const std::lock_guard guard(unfinished().lock);
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const int failure = errno;
  if (descriptor >= 0) unfinished().files.insert(path);
  errno = failure;
  return descriptor;
}

void sync_folder(const fs::path& folder) {
  const Descriptor descriptor(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot sync a folder; the files themselves are synced and in place by now.
  if (descriptor.number() >= 0) ::fsync(descriptor.number());
}

}  // namespace

Bytes read_file(const fs::path& path, std::uint64_t limit) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) fail(fmt::format("{} does not exist.", path.string()));
  if (status.type() == fs::file_type::directory) fail(fmt::format("{} is a folder, not a file.", path.string()));
  if (status.type() != fs::file_type::regular) fail(fmt::format("{} is not a file that can be read.", path.string()));
  const std::uint64_t size = fs::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) fail(fmt::format("{} cannot be opened for reading.", path.string()));
  const std::uint64_t wanted = std::min(size, limit);
  if (wanted > Bytes().max_size()) throw std::bad_alloc();  // addresses of 32 bits
  Bytes bytes(static_cast<std::size_t>(wanted));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size())
    fail(fmt::format("{} cannot be read to its end.", path.string()));
  return bytes;
}

FileReplacement::~FileReplacement() {
  if (pending_.empty()) return;
  const std::lock_guard guard(unfinished().lock);
  std::error_code ignored;
  for (const Pending& file : pending_) {
    fs::remove(file.temporary, ignored);
    unfinished().files.erase(file.temporary);
  }
}

void FileReplacement::add(const fs::path& wanted, std::span<const std::uint8_t> bytes) {
  static std::atomic<unsigned> counter{0};
  const fs::path target = behind_links(wanted);
  struct stat old_file {};
  const bool replaces = ::stat(target.c_str(), &old_file) == 0;
  if (replaces && !S_ISREG(old_file.st_mode))
    fail(fmt::format("{} is not a regular file and cannot be replaced.", target.string()));
  const fs::path temporary =
      target.parent_path() /
      fmt::format(".{}.{}.{}.tmp", target.filename().string().substr(0, 100), ::getpid(), counter++);
  Descriptor file(create_temporary(temporary));
  if (file.number() < 0) fail(fmt::format("{} cannot be written: {}.", target.string(), reason(errno)));
  pending_.push_back({temporary, target});
  write_all(file.number(), bytes, target);
  if (replaces && ::fchmod(file.number(), old_file.st_mode & 07777) != 0) {
    fail(
        fmt::format("{} cannot be given the permissions of the file it replaces: {}.", target.string(), reason(errno)));
  }
  if (::fsync(file.number()) != 0 || !file.close()) {
    fail(fmt::format("{} cannot be written: {}.", target.string(), reason(errno)));
  }
}

void FileReplacement::commit() {
  const std::lock_guard guard(unfinished().lock);
  while (!pending_.empty()) {
    const Pending& file = pending_.front();
    if (::rename(file.temporary.c_str(), file.target.c_str()) != 0) {
      fail(fmt::format("{} cannot be replaced: {}.", file.target.string(), reason(errno)));
    }
    unfinished().files.erase(file.temporary);
    sync_folder(file.target.parent_path());
    pending_.erase(pending_.begin());
  }
}

void abandon_replacements() {
  unfinished().lock.lock();  // for ever
  std::error_code ignored;
  for (const fs::path& file : unfinished().files) fs::remove(file, ignored);
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  while (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace nmc::gltf
