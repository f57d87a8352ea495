// SPDX-License-Identifier: MIT
#include "tools/engines/conformance/job.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace conformance {

namespace fs = std::filesystem;

namespace {

constexpr double kToEnd = 5.0;  // of a job that is told to [s]
constexpr std::size_t kLines = 6;
const std::string kNotJudged = "it ended before it could be judged";

/// A folder of its own for one check.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "bplbm-conformance-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a folder in " + pattern);
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> command(const Check& check, const JobOptions& options,
                                 const std::string& folder, int fluid_ranks) {
  std::vector<std::string> words{options.launcher,
                                 "--bind-to",
                                 "none",
                                 "--oversubscribe",
                                 "-np",
                                 std::to_string(fluid_ranks),
                                 fs::read_symlink("/proc/self/exe").string(),
                                 "--judge",
                                 check.name,
                                 "--folder",
                                 folder,
                                 "--patience",
                                 std::to_string(options.patience),
                                 ":",
                                 "-np",
                                 std::to_string(options.solid_ranks)};
  words.insert(words.end(), options.engine.begin(), options.engine.end());
  return words;
}

/// The child: a process group of its own, its output into a file.
[[noreturn]] void become(const std::vector<std::string>& words, const std::string& output) {
  setpgid(0, 0);
  const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600),
            nothing = open("/dev/null", O_RDONLY);
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  dup2(nothing, STDIN_FILENO);
  if (geteuid() == 0)
    for (const char* name : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"})
      setenv(name, "1", 1);
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 1);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  _exit(127);
}

/// Waits for a child. @return  whether it ended by itself in that time
bool wait_for(pid_t child, double seconds, int& status) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

void end_job(pid_t child, int& status) {
  kill(child, SIGTERM);  // mpirun ends what it has started
  if (wait_for(child, kToEnd, status)) return;
  kill(-child, SIGKILL);
  waitpid(child, &status, 0);
}

/// What the programs said of an error, or else what they said first.
std::string telling_lines(const std::string& text) {
  std::vector<std::string> errors, all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.find(" | error | ") != std::string::npos || line.find("Error: ") != std::string::npos)
      errors.push_back(line);
    if (!line.empty() && !line.starts_with("---")) all.push_back(line);
  }
  const auto& lines = errors.empty() ? all : errors;
  std::string told;
  for (std::size_t i = 0; i < std::min(kLines, lines.size()); ++i) told += lines[i] + "\n";
  return told;
}

/// The first complaint of a rank. Where a check ends the job, ranks that see nothing of it are
/// ended before they can say so: one that is content is enough.
std::string verdict(const Check& check, const std::string& folder, int ranks) {
  int content = 0;
  for (int r = 0; r < ranks; ++r) {
    const std::string text = read_file(fmt::format("{}/verdict.{}", folder, r));
    if (!text.empty() && text != "ok") return text;
    content += !text.empty();
  }
  return content == ranks || (check.exit_code && content) ? "" : kNotJudged;
}

}  // namespace

void write_verdict(const std::string& folder, int rank, const std::string& text) {
  std::ofstream(fmt::format("{}/verdict.{}", folder, rank)) << text;
}

Outcome run_check(const Check& check, const JobOptions& options) {
  const Folder folder;
  const int ranks = std::max(options.fluid_ranks, check.fluid_ranks);
  const std::string output = folder.path() + "/output";
  const auto words = command(check, options, folder.path(), ranks);
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process can be started");
  if (child == 0) become(words, output);
  int status = 0;
  const bool ended = wait_for(child, options.timeout, status);
  if (!ended) end_job(child, status);
  Outcome outcome;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.wrong = verdict(check, folder.path(), ranks);
  if (!ended && (outcome.wrong.empty() || outcome.wrong == kNotJudged))
    outcome.wrong = fmt::format("the job does not end within {:.3g} s", options.timeout);
  if (outcome.wrong.empty() && code != check.exit_code)
    outcome.wrong = fmt::format("the job's exit code is {} instead of {}", code, check.exit_code);
  if (code == 127) outcome.wrong = options.launcher + " not found";
  outcome.said = telling_lines(read_file(output));
  return outcome;
}

}  // namespace conformance
