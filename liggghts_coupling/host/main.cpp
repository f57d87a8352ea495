// SPDX-License-Identifier: GPL-2.0-or-later
/// Our `liggghts`: Debian's library, our styles, and a place in a coupled MPI job. Started alone it
/// is plain LIGGGHTS.
#include <fmt/format.h>
#include <input.h>
#include <lammps.h>
#include <mpi.h>
#include <sys/mman.h>
#include <universe.h>
#include <variable.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "liggghts_coupling/bond/pair_bond.h"
#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/mpi_guards.h"
#include "liggghts_coupling/host/register_styles.h"
#include "liggghts_coupling/host/screen_ear.h"
#include "liggghts_coupling/host/script_names.h"
#include "protocol/program/input_file.h"
#include "protocol/program/mpi_start.h"
#include "protocol/program/program.h"
#include "protocol/program/watch.h"

namespace dem {

Coupling& Coupling::instance() {
  static Coupling coupling;
  return coupling;
}

namespace {

constexpr double kHandshakeSeconds =
    60.0;  // the fluid sends its handshake as soon as it has read its scene

using Arguments = std::vector<std::string>;

/// Value of an option given as any of two names; empty where absent.
std::string option(const Arguments& arguments, const char* name, const char* alias) {
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i)
    if (arguments[i] == name || arguments[i] == alias) return arguments[i + 1];
  return {};
}

bool defines(const Arguments& arguments, const std::string& variable) {
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i)
    if ((arguments[i] == "-var" || arguments[i] == "-v") && arguments[i + 1] == variable)
      return true;
  return false;
}

/// What a script may count on without a fluid that says more: the folder of the script, for what it
/// includes, the one for its output, and that it begins at the beginning.
void add_defaults(Arguments& arguments) {
  const auto folder = std::filesystem::path(option(arguments, "-in", "-i")).parent_path();
  for (const auto& [name, value] :
       {std::pair<const char*, std::string>{"scene_folder", folder.empty() ? "." : folder.string()},
        {"out_folder", "out"},
        {"restart", "0"},
        {"restart_file", "none"}})
    if (!defines(arguments, name)) arguments.insert(arguments.end(), {"-var", name, value});
}

/// What the fluid offers becomes a script variable, unless the command line has its own. Where the
/// script includes files from is no matter of the fluid's.
void add_offered_variables(Arguments& arguments, const protocol::Hello& fluid) {
  Arguments added;
  for (const auto& v : fluid.variables)
    if (v.name != "scene_folder" && !defines(arguments, v.name))
      added.insert(added.end(), {"-var", v.name, v.value});
  arguments.insert(arguments.end(), added.begin(), added.end());
}

void check_script(const Arguments& arguments) {
  const std::string script = option(arguments, "-in", "-i");
  const std::string problem = script.empty() ? "" : protocol::why_unreadable(script);
  if (problem.empty()) return;
  throw protocol::ProgramError(
      fmt::format("{}: {}; give -in SCRIPT, or start in a folder with in.liggghts", script,
                  problem),
      protocol::kBadInput);
}

/// What LIGGGHTS writes and says, and where its last error can be found.
struct Output {
  std::string script, log, screen;
  LAMMPS_NS::LAMMPS* lammps = nullptr;
  ScreenEar ear;
  std::set<std::string> warned;  // what was said already

  void listen();
  void warn(const std::string& line);

  std::string reason();
};

/// Gives access to the line of the script that LIGGGHTS is at.
struct ScriptLine : LAMMPS_NS::Input {
  static std::string of(const LAMMPS_NS::LAMMPS* lammps) {
    const char* line = lammps && lammps->input ? lammps->input->*&ScriptLine::line : nullptr;
    return line ? line : "";
  }
};

/// What LIGGGHTS warns of, for the user's terminal and the log, each once with its line of the
/// script.
void Output::warn(const std::string& line) {
  constexpr std::size_t most = 50;
  std::string text = without_source(line);
  if (const auto at = text.find(": "); at != std::string::npos) text.erase(0, at + 2);
  std::string cause = ScriptLine::of(lammps);
  while (!cause.empty() && std::isspace(static_cast<unsigned char>(cause.back()))) cause.pop_back();
  text = fmt::format("liggghts | warning | {} (at the line: {})\n", text, cause);
  if (warned.size() > most || !warned.insert(text).second) return;
  if (warned.size() > most) text = "liggghts | warning | there are more; they are not told\n";
  std::fputs(text.c_str(), stderr);
  if (lammps && lammps->logfile) std::fputs(text.c_str(), lammps->logfile);
}

/// Why LIGGGHTS has ended itself. Of a variable that is not there, it does not say the name.
std::string Output::reason() {
  std::fflush(nullptr);  // LIGGGHTS has not
  const std::string found = without_source(
      ear.last_error().empty() ? protocol::last_error_line({log, screen}) : ear.last_error());
  const std::string advice = advice_for(found);
  const std::string said = found.empty()    ? "LIGGGHTS stopped with an error; see its output"
                           : advice.empty() ? found
                                            : found + "; what to do: " + advice;
  // a variable that cannot be read ends it once more, and leads here again
  LAMMPS_NS::LAMMPS* const one = std::exchange(lammps, nullptr);
  if (!one || (!found.empty() && found.find("illegal variable") == std::string::npos)) return said;
  const auto value = [one](std::string name) -> std::optional<std::string> {
    LAMMPS_NS::Variable& variables = *one->input->variable;
    if (variables.find(name.data()) < 0) return std::nullopt;
    const char* text = variables.retrieve(name.data());
    return text ? text : "";
  };
  const auto undefined = undefined_names(script, value);
  if (undefined.empty()) return said;
  return fmt::format("{}: nothing defines {}; lbm check --liggghts-vars SCENE lists what it offers",
                     said, fmt::join(undefined, ", "));
}

/// Hears what LIGGGHTS says from here on. What kept its screen until now is no longer needed.
void Output::listen() {
  std::FILE* const before = lammps->screen;
  std::FILE* const stream = ear.listen(screen.empty() ? before : nullptr);
  if (!stream) return;
  ear.tell_warnings([this](const std::string& line) { warn(line); });
  lammps->screen = lammps->universe->uscreen = stream;
  if (!screen.empty() && before) std::fclose(before);
  screen.clear();
}

/// With `-screen none` LIGGGHTS would say nothing of an error on one rank, which its log has not:
/// it writes to memory instead, until it is there and we can listen.
std::string keep_screen(Arguments& arguments) {
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    if ((arguments[i] != "-screen" && arguments[i] != "-sc") || arguments[i + 1] != "none")
      continue;
    const int file = memfd_create("screen", 0);
    if (file >= 0) return arguments[i + 1] = fmt::format("/proc/self/fd/{}", file);
  }
  return {};
}

void run_script(Arguments& arguments, MPI_Comm local, Output& output) {
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  register_bonds();
  auto* lammps = new LAMMPS_NS::LAMMPS(static_cast<int>(argv.size()), argv.data(), local);
  output.lammps = lammps;
  if (Coupling::instance().channel) output.listen();
  register_styles(*lammps);
  if (Coupling::instance().channel)
    protocol::catch_signals();  // after LIGGGHTS set its own handlers
  lammps->input->file();
  Coupling& coupling = Coupling::instance();
  if (coupling.session && !coupling.over)
    coupling.session->goodbye(coupling.agreed
                                  ? "its script ended before the fluid's end time"
                                  : "its script ended without fix lbm/couple and a run");
  output.lammps = nullptr;
  delete lammps;
}

void run(Arguments& arguments) {
  Coupling& coupling = Coupling::instance();
  coupling.world = protocol::connect(protocol::Role::Solid);
  // never freed: LIGGGHTS may speak until the process has ended
  Output& output = *new Output{.log = option(arguments, "-log", "-l")};
  if (output.log.empty()) output.log = "log.liggghts";
  guard_mpi(coupling.world.local, [&output] { return output.reason(); });
  if (coupling.world.coupled()) {
    coupling.channel = protocol::make_mpi_channel(coupling.world, protocol::Role::Solid);
    if (option(arguments, "-in", "-i").empty())
      arguments.insert(arguments.end(), {"-in", "in.liggghts"});
    check_script(arguments);
    coupling.session =
        std::make_unique<protocol::SolidSession>(*coupling.channel, kHandshakeSeconds);
    protocol::limit_waits(coupling.session->timeout());
    add_offered_variables(arguments, coupling.session->fluid());
  } else {
    check_script(arguments);
  }
  add_defaults(arguments);
  output.script = option(arguments, "-in", "-i");
  if (coupling.world.coupled()) output.screen = keep_screen(arguments);
  run_script(arguments, coupling.world.local, output);
}

}  // namespace
}  // namespace dem

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // LIGGGHTS aborts without flushing
  {
    const protocol::MpiStart bounded("liggghts");
    MPI_Init(&argc, &argv);
  }
  dem::Arguments arguments(argv, argv + argc);
  dem::Coupling& coupling = dem::Coupling::instance();
  int code = protocol::kOk;
  try {
    dem::run(arguments);
  } catch (const std::exception& error) {  // LIGGGHTS itself is left as it is: it cannot be unwound
    code = protocol::leave_after(error, "liggghts", coupling.channel.get());
  }
  if (code == protocol::kOk && coupling.session && protocol::signalled())
    code = protocol::kFault;  // it ended in good order, but early
  return protocol::finish(code, "liggghts", coupling.channel, coupling.world.local);
}
