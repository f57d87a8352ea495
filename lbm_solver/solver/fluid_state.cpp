// SPDX-License-Identifier: GPL-2.0-or-later
/// What the coming steps of a fluid depend on, saved and loaded.
#include <stdexcept>

#include "lbm_solver/solver/fluid.h"

namespace lbm {

Record Fluid::save_boundary(std::size_t number) const {
  Patch& patch = *patches_[number];
  std::vector<double> lines;
  for (std::size_t k = 0; k < patch.memory().size(); ++k)
    lines.insert(lines.end(), {static_cast<double>(patch.links()[k].number), patch.memory()[k]});
  lines = ranks_->collect(lines);
  std::vector<double> links(lines.size() / 2);
  for (std::size_t k = 0; k < lines.size(); k += 2)
    links[static_cast<std::size_t>(lines[k])] = lines[k + 1];
  Record record;
  record.set("links", std::move(links));
  record.set("mass_in", ranks_->collect_parts({patch.mass_in()}));
  return record;
}

void Fluid::load_boundary(std::size_t number, const Record& record) {
  const auto& links = record.get<std::vector<double>>("links");
  std::vector<double>& memory = patches_[number]->memory();
  for (std::size_t k = 0; k < memory.size(); ++k) {
    const auto link = static_cast<std::size_t>(patches_[number]->links()[k].number);
    if (link >= links.size()) throw std::invalid_argument("'links' is of another size");
    memory[k] = links[link];
  }
  patches_[number]->set_mass_in(ranks_->own_part(record.get<std::vector<double>>("mass_in"), 1)[0]);
}

Record Fluid::save() const {
  Record record;
  const auto read = [this](const CellRange& piece, std::span<double> to) {
    const auto q_count = static_cast<std::size_t>(lattice().Q);
    const Cell3& first = cells().begin;
    piece.each([&](const Cell3& c, std::size_t number) {
      for (int q = 0; q < lattice().Q; ++q)
        to[number * q_count + q] = arriving(q, c[0] - first[0], c[1] - first[1], c[2] - first[2]);
    });
  };
  record.set("populations",
             CellValues{domain().cells(), lattice().Q, f_.precision() == Precision::Single,
                        range_of(cells()), read});
  record.set("steps", steps_);
  record.set("odd", std::int64_t{stream_.odd()});
  for (std::size_t i = 0; i < patches_.size(); ++i)
    record.set("boundary" + std::to_string(i + 1), save_boundary(i));
  if (scheme_) record.set("scheme", scheme_->save());
  if (flow_) record.set("flow", flow_->save());
  if (pressure_) record.set("pressure", pressure_->save());
  if (wale_) record.set("eddies", wale_->save());
  if (two_steps_.on()) {
    TwoStepLoads last = two_steps_;
    if (loads_are_new_) last.remember(bodies_, cover_->loads());
    record.set("loads", last.save(*ranks_));
    if (!fixed_.empty()) {
      TwoStepLoads fixed = fixed_two_steps_;
      if (loads_are_new_) fixed.remember(fixed_, cover_->fixed_loads());
      record.set("fixed_loads", fixed.save(*ranks_));
    }
  }
  return record;
}

void Fluid::load(const Record& record) {
  for (std::size_t i = 0; i < patches_.size(); ++i)
    load_boundary(i, record.part("boundary" + std::to_string(i + 1)));
  if (scheme_) scheme_->load(record.part("scheme"));
  if (flow_) flow_->load(record.part("flow"));
  if (pressure_) {
    pressure_->load(record.part("pressure"));
    static_cast<PressurePatch&>(*patches_[pressure_->patch()]).hold(pressure_->drho());
  }
  if (wale_) wale_->load(record.part("eddies"));
  if (two_steps_.on()) {
    two_steps_.load(record.part("loads"));
    if (!fixed_.empty()) fixed_two_steps_.load(record.part("fixed_loads"));
    loads_are_new_ = false;
  }
  const CellValues& populations = record.cells("populations", domain().cells(), lattice().Q);
  if (!populations.here.holds(range_of(cells())))
    throw std::invalid_argument("'populations' are of cells of another rank");
  steps_ = record.integer("steps");
  move_shapes();
  stream_.set_odd(record.integer("odd") != 0);
  if (force_in_time_.changes_after(0) || flow_) set_body_force();
  load_populations(populations);
}

/// In pieces: of single precision, all of them would take twice the room of the lattice.
void Fluid::load_populations(const CellValues& populations) {
  const auto q_count = static_cast<std::size_t>(lattice().Q);
  const Cell3& first = cells().begin;
  std::vector<double> values;
  for (const CellRange& piece : pieces_of(range_of(cells()), q_count * sizeof(double))) {
    values.resize(q_count * piece.count());
    populations.read(piece, values);
    piece.each([&](const Cell3& c, std::size_t number) {
      for (int q = 0; q < lattice().Q; ++q)
        arriving(q, c[0] - first[0], c[1] - first[1], c[2] - first[2]) =
            values[number * q_count + q];
    });
  }
}

}  // namespace lbm
