// What emscripten's C library leaves out although Node has it. Strong symbols here take the place of the library's own.
#include <emscripten.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>

// clang-format off
EM_JS(int, nmc_sync_file, (int file), {
  try {
    require('fs').fsyncSync(FS.streams[file].nfd);
    return 0;
  } catch (failure) {
    return ERRNO_CODES[failure.code] || ERRNO_CODES.EIO;
  }
});
EM_JS(int, nmc_is_terminal, (int file), {
  return require('tty').isatty(file) ? 1 : 0;
});
EM_JS(int, nmc_process_id, (), {
  return process.pid;
});
EM_JS(int, nmc_terminal_columns, (), {
  return Module['columns'];
});
// clang-format on

extern "C" {

/// The library's is always 42, and two runs at the same time would want the same temporary file.
pid_t getpid() { return nmc_process_id(); }

/// The library's does nothing.
int fsync(int file) {
  errno = nmc_sync_file(file);
  return errno == 0 ? 0 : -1;
}

/// The library's takes every standard stream for a terminal.
int isatty(int file) { return nmc_is_terminal(file); }

/// Only the width of a terminal is asked for.
int ioctl(int file, int request, ...) {
  if (request != TIOCGWINSZ || !isatty(file)) {
    errno = ENOTTY;
    return -1;
  }
  va_list arguments;
  va_start(arguments, request);
  *va_arg(arguments, winsize*) = {0, static_cast<unsigned short>(nmc_terminal_columns()), 0, 0};
  va_end(arguments);
  return 0;
}
}
