// SPDX-License-Identifier: MIT
/// `bplbm-conformance [CHECK…] -- ENGINE…`: whether a solid program keeps to the protocol. For each
/// check it starts an MPI job of itself as the fluid (--judge) and of the engine.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <future>
#include <semaphore>
#include <sstream>

#include "protocol/program/command_line.h"
#include "protocol/program/program.h"
#include "protocol/transport/mpi_channel.h"
#include "tools/engines/conformance/job.h"

namespace {

using namespace conformance;
using namespace protocol;

const std::string kProgram = "bplbm-conformance";

/// This program as the fluid of a job.
int judge(const std::string& name, const std::string& folder, double patience) {
  MPI_Init(nullptr, nullptr);
  catch_signals();
  std::unique_ptr<Channel> channel;
  World world;
  const Check& check = *find(name);
  int code = 0, rank = 0;
  try {
    world = connect(Role::Fluid);
    MPI_Comm_rank(world.local, &rank);
    channel = make_mpi_channel(world, Role::Fluid);
    Judge it(*channel, world.local, folder, patience);
    check.run(it);
    write_verdict(folder, rank, check.exit_code ? "it was not refused" : "ok");
  } catch (const Aborts& done) {
    write_verdict(folder, rank, "ok");
    abort_job(done.exit_code);
  } catch (const Wrong& wrong) {
    write_verdict(folder, rank, wrong.what());
    code = leave_after(ProtocolError(wrong.what()), kProgram, channel.get());
  } catch (const std::exception& error) {
    const bool wanted = check.exit_code && exit_code_of(error) == check.exit_code;
    if (!signalled()) write_verdict(folder, rank, wanted ? "ok" : error.what());
    code = leave_after(error, kProgram, channel.get());
  }
  return finish(code, kProgram, channel, world.local);
}

std::string list() {
  std::string text = "What an engine must do:\n";
  for (const Check& c : checks())
    text += fmt::format("  {:12} {}{}\n", c.name, c.must,
                        (c.exit_code ? fmt::format(" (exit code {})", c.exit_code) : "") +
                            (c.optional ? " (made where it is named)" : ""));
  return text;
}

void print(const Check& check, const Outcome& outcome) {
  const bool good = outcome.wrong.empty();
  fmt::print("{:12} {:4} {:5.1f} s  {}\n", check.name, good ? "yes" : "NO", outcome.seconds,
             check.must);
  if (!good) fmt::print("{:25}wrong: {}\n", "", outcome.wrong);
  std::istringstream said(good ? "" : outcome.said);
  for (std::string line; std::getline(said, line);)
    if (line.find(outcome.wrong) == std::string::npos) fmt::print("{:25}it said: {}\n", "", line);
  std::fflush(stdout);
}

/// Some jobs at a time; the table in the order of the names. @return  whether all passed
bool run_all(const std::vector<std::string>& names, const JobOptions& options, int jobs) {
  fmt::print("{} | {} fluid and {} solid rank(s): {}\n", kProgram, options.fluid_ranks,
             options.solid_ranks, fmt::join(options.engine, " "));
  std::counting_semaphore<> free(jobs);
  std::vector<std::future<Outcome>> outcomes;
  for (const std::string& name : names)
    outcomes.push_back(std::async(std::launch::async, [&options, &free, check = find(name)] {
      free.acquire();
      const Outcome outcome = run_check(*check, options);
      free.release();
      return outcome;
    }));
  std::size_t passed = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Outcome outcome = outcomes[i].get();
    passed += outcome.wrong.empty();
    print(*find(names[i]), outcome);
  }
  fmt::print("{} | {} of {} checks passed\n", kProgram, passed, names.size());
  return passed == names.size();
}

int start(int argc, char** argv) {
  char** const dashes = std::find(argv, argv + argc, std::string("--"));
  JobOptions options;
  std::vector<std::string> names;
  bool only_list = false;
  int jobs = 1;
  CLI::App app{
      "Whether an engine keeps to the protocol of lbm's solid side: bplbm-conformance "
      "[CHECK…] -- ENGINE…"};
  app.footer(list() +
             "The engine gets a box of 1 × 1 m and its discs as variables, as lbm offers them; "
             "tools/engines/conformance/README.md says which.\n"
             "Exit code: 0 all passed, 1 some failed, 2 a mistake in the command line.");
  app.add_option("CHECK", names,
                 "checks to make, in this order; all but clump where none is given");
  app.add_flag("--list", only_list, "the checks, and what an engine must do");
  app.add_option("--fluid-ranks", options.fluid_ranks, "ranks of the judge")
      ->check(CLI::Range(1, 64));
  app.add_option("--solid-ranks", options.solid_ranks, "ranks of the engine")
      ->check(CLI::Range(1, 64));
  app.add_option("--timeout", options.timeout, "of one check [s]")->check(finite_number(0.0));
  app.add_option("--patience", options.patience, "how long the engine may take for an answer [s]")
      ->check(finite_number(0.0));
  app.add_option("--jobs", jobs, "checks at a time")->check(CLI::Range(1, 64));
  app.add_option("--launcher", options.launcher, "the command mpirun");
  if (const auto code = read_command_line(app, kProgram, static_cast<int>(dashes - argv), argv))
    return *code;
  if (only_list) {
    fmt::print("{}", list());
    return kOk;
  }
  if (dashes != argv + argc) options.engine.assign(dashes + 1, argv + argc);
  const auto complain = [](const std::string& what) {
    fmt::print(stderr, "{} | error | {}; {} --help shows what there is\n", kProgram, what,
               kProgram);
    return kBadInput;
  };
  if (options.engine.empty())
    return complain("which engine? give its command after --, e.g. -- python3 my_engine.py");
  for (const std::string& name : names)
    if (!find(name)) return complain("no check is called '" + name + "'");
  if (names.empty())
    for (const Check& c : checks())
      if (!c.optional) names.push_back(c.name);
  return run_all(names, options, jobs) ? kOk : kFault;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 6 && words[0] == "--judge" && find(words[1]))
    return judge(words[1], words[3], std::stod(words[5]));
  try {
    return start(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{} | error | {}\n", kProgram, error.what());
    return kFault;
  }
}
