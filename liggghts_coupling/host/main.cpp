// SPDX-License-Identifier: GPL-2.0-or-later
/// Our `liggghts`: Debian's library, our styles, and a place in a coupled MPI job. Started alone it
/// is plain LIGGGHTS.
#include <fmt/format.h>
#include <input.h>
#include <lammps.h>
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "liggghts_coupling/bond/pair_bond.h"
#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/mpi_guards.h"
#include "liggghts_coupling/host/register_styles.h"
#include "protocol/program.h"

namespace dem {

Coupling& Coupling::instance() {
  static Coupling coupling;
  return coupling;
}

namespace {

constexpr double kHelloSeconds = 60.0;  // the fluid says hello as soon as it has read its scene

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

/// What the fluid offers becomes a script variable, unless the command line has its own.
void add_offered_variables(Arguments& arguments, const protocol::Hello& fluid) {
  Arguments added;
  for (const auto& v : fluid.variables)
    if (!defines(arguments, v.name)) added.insert(added.end(), {"-var", v.name, v.value});
  arguments.insert(arguments.end(), added.begin(), added.end());
}

void check_script(const Arguments& arguments) {
  const std::string script = option(arguments, "-in", "-i");
  if (script.empty() || std::filesystem::is_regular_file(script)) return;
  throw protocol::ProtocolError(
      fmt::format("{}: no such script; give -in FILE, or start in a folder with in.liggghts",
                  script),
      protocol::kBadInput);
}

void run_script(Arguments& arguments, MPI_Comm local) {
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  register_bonds();
  auto* lammps = new LAMMPS_NS::LAMMPS(static_cast<int>(argv.size()), argv.data(), local);
  register_styles(*lammps);
  if (Coupling::instance().channel)
    protocol::catch_signals();  // after LIGGGHTS set its own handlers
  lammps->input->file();
  Coupling& coupling = Coupling::instance();
  if (coupling.session && !coupling.over)
    coupling.session->goodbye(coupling.agreed
                                  ? "its script ended before the fluid's end time"
                                  : "its script ended without fix lbm/couple and a run");
  delete lammps;
}

void run(Arguments& arguments) {
  Coupling& coupling = Coupling::instance();
  coupling.world = protocol::connect(protocol::Role::Solid);
  const std::string log = option(arguments, "-log", "-l");
  guard_mpi(coupling.world.local, log.empty() ? "log.liggghts" : log);
  if (coupling.world.coupled()) {
    coupling.channel = protocol::make_mpi_channel(coupling.world, protocol::Role::Solid);
    if (option(arguments, "-in", "-i").empty())
      arguments.insert(arguments.end(), {"-in", "in.liggghts"});
    check_script(arguments);
    coupling.session = std::make_unique<protocol::SolidSession>(*coupling.channel, kHelloSeconds);
    add_offered_variables(arguments, coupling.session->fluid());
  } else {
    check_script(arguments);
  }
  add_defaults(arguments);
  run_script(arguments, coupling.world.local);
}

}  // namespace
}  // namespace dem

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // LIGGGHTS aborts without flushing
  MPI_Init(&argc, &argv);
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
  coupling.session.reset();
  coupling.channel.reset();
  protocol::disconnect(coupling.world);
  dem::finalize_mpi();
  return code;
}
