// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/cell_fields.h"

#include <algorithm>

namespace lbm {

bool CellFields::has(const std::string& name) const {
  return std::ranges::any_of(fields, [&](const CellField& f) { return name == f.name; });
}

int CellFields::components() const {
  int numbers = 0;
  for (const CellField& field : fields) numbers += field.components;
  return numbers;
}

void send_fields(const CellFields& fields, const Decomposition& ranks) {
  ranks.in_pieces<float>(fields.components(), fields.make, {});
}

}  // namespace lbm
