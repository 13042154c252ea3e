// Runs a program as a user would and keeps what it said.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

extern char** environ;

namespace nmc::test {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal number where a signal ended it
  bool timed_out = false;
  std::string out;
  std::string err;
};

/// Runs `arguments` (the program first, looked up in PATH) with closed standard input; kills it after `timeout`.
inline ProcessResult run_process(const std::vector<std::string>& arguments,
                                 std::chrono::seconds timeout = std::chrono::seconds(120)) {
  std::array<std::array<int, 2>, 2> pipes{};
  for (auto& p : pipes) {
    if (pipe2(p.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipes[0][1], 1);
  posix_spawn_file_actions_adddup2(&actions, pipes[1][1], 2);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(pipes[0][1]);
  close(pipes[1][1]);
  if (failure != 0) {
    close(pipes[0][0]);
    close(pipes[1][0]);
    throw std::runtime_error("cannot run " + arguments[0]);
  }

  ProcessResult result;
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  std::array<pollfd, 2> waits{{{pipes[0][0], POLLIN, 0}, {pipes[1][0], POLLIN, 0}}};
  while (waits[0].fd >= 0 || waits[1].fd >= 0) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      result.timed_out = true;
      kill(child, SIGKILL);
      break;
    }
    poll(waits.data(), waits.size(), static_cast<int>(left.count()));
    for (std::size_t i = 0; i < waits.size(); ++i) {
      if (waits[i].fd < 0 || waits[i].revents == 0) continue;
      std::array<char, 4096> buffer{};
      const ssize_t got = read(waits[i].fd, buffer.data(), buffer.size());
      if (got > 0) {
        (i == 0 ? result.out : result.err).append(buffer.data(), static_cast<std::size_t>(got));
      } else {
        waits[i].fd = -1;
      }
    }
  }
  close(pipes[0][0]);
  close(pipes[1][0]);
  int status = 0;
  waitpid(child, &status, 0);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace nmc::test
