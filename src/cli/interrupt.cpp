#include "cli/interrupt.h"

#include <csignal>
#include <system_error>
#include <thread>

#include "base/platform.h"
#include "gltf/files.h"

namespace nmc::cli {
namespace {

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// Waits for one of the signals in a thread of its own, where everything is allowed that a handler must not do.
void wait_for(sigset_t signals) {
  int signal = 0;
  if (sigwait(&signals, &signal) != 0) return;
  gltf::abandon_replacements();
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  std::raise(signal);
}

/// Takes the signals that the caller does not ignore away from all threads, for the one that waits.
[[maybe_unused]] void start_waiting() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (!is_ignored(signal)) sigaddset(&signals, signal);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  try {
    std::thread(wait_for, signals).detach();
  } catch (const std::system_error&) {
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  }
}

}  // namespace

void end_cleanly_on_signals() {
  // Without threads there are no signals either: whoever runs the WebAssembly gets them.
  if constexpr (has_threads) {
    std::signal(SIGXFSZ, SIG_IGN);
    start_waiting();
  }
}

}  // namespace nmc::cli
