// SPDX-License-Identifier: GPL-2.0-or-later
#include "tests/support/job.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace test {
namespace {

/// In the child: a process group of its own, output into the pipe, the command through a shell.
[[noreturn]] void become(const std::string& command, const std::string& folder, int output) {
  setpgid(0, 0);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  for (int fd = 3; fd < 256; ++fd) close(fd);
  if (chdir(folder.c_str()) != 0) _exit(127);
  execl("/bin/bash", "bash", "-c", command.c_str(), nullptr);
  _exit(127);
}

}  // namespace

JobResult run(const std::string& command, const std::string& folder, double limit_seconds) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) become(command, folder, ends[1]);
  close(ends[1]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);

  JobResult result;
  std::array<char, 4096> buffer;
  const auto drain = [&] {
    for (ssize_t n; (n = read(ends[0], buffer.data(), buffer.size())) > 0;)
      result.output.append(buffer.data(), n);
  };
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    drain();
    if (elapsed() > limit_seconds * BPLBM_PATIENCE) {
      result.timed_out = true;
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      break;
    }
    pollfd waiting{ends[0], POLLIN, 0};
    poll(&waiting, 1, 20);
  }
  drain();
  kill(-child, SIGKILL);  // nothing it started may outlive it
  close(ends[0]);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "bplbm-test-").string();
  pattern += std::string(6, 'X');  // mkdtemp puts a name there
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a temporary folder");
  path_ = pattern;
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}
std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const std::string path = path_ + "/" + name;
  std::ofstream(path) << text;
  return path;
}

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::vector<double>> read_rows(const std::string& path) {
  std::istringstream text(read_file(path));
  std::vector<std::vector<double>> rows;
  std::string line, word;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream words(line);
    rows.emplace_back();
    while (std::getline(words, word, ','))
      rows.back().push_back(std::strtod(word.c_str(), nullptr));
  }
  return rows;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "nothing to replace: " << from;
  for (; at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace test
